#pragma once
// The motion at a moment: at a row of a trace, or between two rows, by the cubics through values and slopes at both.

#include <cstddef>

#include <Eigen/Core>

namespace hertzline {

/// One row of a trace: displacements, velocities and accelerations of the probed bodies.
struct TraceRow {
    TraceRow(const double* row, std::size_t bodies) noexcept : x(row), v(row + bodies), a(row + 2 * bodies) {}
    const double* x;
    const double* v;
    const double* a;
};

/// The chain's far end at one moment.
struct FarEnd {
    Eigen::Array2d velocities;  ///< of the last sphere and of the end [m/s]
    double approach;            ///< how much nearer they are than at rest [m]
};
inline FarEnd far_end(const double* displacements, const double* velocities) noexcept {
    return {{velocities[0], velocities[1]}, displacements[0] - displacements[1]};
}

/// A quantity between two rows: the cubic through values and slopes.
template <class Value>
class Cubic {
public:
    /// The slopes are those by the fraction of the way.
    Cubic(const Value& from, const Value& slope, const Value& to, const Value& slope_there) noexcept
        : value_(from),
          slope_(slope),
          square_(3 * (to - from) - 2 * slope - slope_there),
          cube_(slope + slope_there - 2 * (to - from)) {}
    Value at(double z) const noexcept { return value_ + z * (slope_ + z * (square_ + z * cube_)); }

private:
    Value value_, slope_, square_, cube_;
};

/// The far end between two rows, its cubics worked out once for all samples there.
class FarEndPiece {
public:
    /// @param last index of the last sphere @param length [s]
    FarEndPiece(const TraceRow& from, const TraceRow& to, std::size_t last, double length) noexcept
        : FarEndPiece(far_end(from.x + last, from.v + last), far_end(from.v + last, from.a + last),
                      far_end(to.x + last, to.v + last), far_end(to.v + last, to.a + last), length) {}
    FarEnd at(double z) const noexcept { return {velocities_.at(z), approach_.at(z)}; }

private:
    FarEndPiece(const FarEnd& from, const FarEnd& slope, const FarEnd& to, const FarEnd& slope_there,
                double length) noexcept
        : velocities_(from.velocities, length * slope.velocities, to.velocities,
                      length * slope_there.velocities),
          approach_(from.approach, length * slope.approach, to.approach, length * slope_there.approach) {}

    Cubic<Eigen::Array2d> velocities_;
    Cubic<double> approach_;
};

/// A moment between two rows.
struct BetweenRows {
    TraceRow from;
    TraceRow to;
    const FarEndPiece& piece;
    double length;  ///< from row to row [s]
    double z;       ///< fraction of that
    FarEnd far_end(std::size_t /*last*/) const noexcept { return piece.at(z); }
    double displacement(std::size_t body) const noexcept {
        return Cubic(from.x[body], length * from.v[body], to.x[body], length * to.v[body]).at(z);
    }
    double velocity(std::size_t body) const noexcept {
        return Cubic(from.v[body], length * from.a[body], to.v[body], length * to.a[body]).at(z);
    }
};

/// A moment that is a row.
struct AtRow {
    TraceRow row;
    FarEnd far_end(std::size_t last) const noexcept { return hertzline::far_end(row.x + last, row.v + last); }
    double displacement(std::size_t body) const noexcept { return row.x[body]; }
    double velocity(std::size_t body) const noexcept { return row.v[body]; }
};

}  // namespace hertzline
