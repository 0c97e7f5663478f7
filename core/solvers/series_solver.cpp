#include "core/solvers/series_solver.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "core/integrators/kernels.hpp"
#include "core/integrators/stability.hpp"
#include "core/model/contact_law.hpp"
#include "core/model/drive.hpp"
#include "core/plate/quadrature.hpp"
#include "core/scene/text.hpp"

namespace hertzline {

namespace {

// Error of a piece relative to the drive's velocity, and the longest piece that goes with it, as the phase of
// the chain's fastest oscillation: tolerance = at_one * phase^exponent. It falls faster than the series'
// order, so that pieces where contacts switch and those where nothing happens stay in proportion.
constexpr double at_one = 1e-10;
constexpr double exponent = 15;
constexpr double rounding = 1e-15;
constexpr double coarsest = 3e-3;

// A body that moves less, relative to the velocities of the scene, stands still: that is far below rounding.
constexpr double still_share = 1e-20;
constexpr Eigen::Index laid_out_at_least = 64;  // bodies

constexpr FixedTime for_good{std::numeric_limits<std::int64_t>::max(), 0};

// Pieces within the time of the longest: more mean that the motion stands still.
constexpr std::int64_t max_pieces = 65536;

/// Velocity of the order of those that the scene will show [m/s]. @param omega of the fastest oscillation [rad/s]
double velocity_scale(const Chain& chain, const Drive& drive, double omega) {
    const double given = std::max(largest_velocity(drive), std::abs(chain.impact_velocity));
    const double kick = (chain.bias * chain.inv_mass).abs().maxCoeff() / omega;
    return std::max(given, std::isfinite(kick) ? kick : 0);
}

/// Overlap [m] whose forces change a velocity by less than the tolerance [m/s] in a step. Below it a
/// contact is taken as just touching, so that the tails of a wave in a chain without preload, which fall like
/// a double exponential, need no resolving. A chain at rest under its preload must not be taken so.
/// @param tolerance [m/s] @param step [s]
double negligible_overlap(const Chain& chain, double tolerance, double step) noexcept {
    constexpr double share = 1e-3;
    const auto largest = [&chain](const Eigen::ArrayXd& of_contacts) {
        double most = 0;
        for (Eigen::Index contact = 0; contact < chain.bodies(); ++contact) {
            most = std::max(most, of_contacts[contact] * chain.mobility(contact));
        }
        return most;
    };
    const double stiffest = largest(chain.stiffness);
    double overlap = std::pow(share * tolerance / (stiffest * step), 2.0 / 3);
    if (chain.damping_law !=
        DampingLaw::dashpot) {  // whose force grows from zero, but faster than the elastic one
        const double power = damping_exponent(chain.damping_law) + 1;
        const double strongest = largest(chain.damping) / power;
        overlap = std::min(overlap, std::pow(share * tolerance / strongest, 1 / power));
    }
    const double least_at_rest = (chain.static_overlap > 0)
                                     .select(chain.static_overlap, std::numeric_limits<double>::infinity())
                                     .minCoeff();
    return std::min(overlap, 1e-6 * least_at_rest);
}

}  // namespace

double SeriesSolver::phase_for(double tolerance) noexcept {
    return std::pow(tolerance / at_one, 1 / exponent);
}

SeriesSolver::SeriesSolver(const ResolvedScene& resolved, const Chain& chain,
                           const SimulationOptions& options, const DiscPlaces& places)
    : chain_(chain),
      options_(options),
      sample_period_s_(1 / resolved.scene().output.sample_rate_hz),
      horn_(resolved.scene().drive, sample_period_s_, options.live),
      state_(chain),
      integrator_(resolved.integrator()),
      simd_chain_(chain, integrator_, kernels::kernel_lanes()),
      piece_((simd_chain_.load(chain, state_, chain.bodies()), simd_chain_.slots()),
             kernels::series_degree(integrator_), horn_.waves(resolved.scene().drive, resolved.step_s()),
             chain.damping_law),
      plate_(chain.end.plate ? std::make_unique<kernels::PlateMotion>(
                                   *chain.end.plate, kernels::kernel_lanes(),
                                   kernels::series_degree(integrator_), resolved.step_s())
                             : nullptr),
      samples_(chain, state_, simd_chain_, piece_, sample_period_s_),
      plate_outputs_(chain, plate_.get(), piece_, resolved, options.taps, places),
      end_taps_(chain, resolved.scene(), options),
      contact_forces_(chain, end_taps_.horn()) {
    const Drive& drive = resolved.scene().drive;
    const Eigen::ArrayXd overlaps = expected_overlaps(chain, drive);
    const double omega = fastest_frequency(chain, overlaps);
    const double unit = resolved.step_s();
    simd_chain_.step_s = unit;
    piece_.unit_s = unit;
    piece_.per_unit = 1 / unit;
    scale_ = velocity_scale(chain, drive, omega);
    // stiffer contacts beyond those that pilots saw must not make pieces coarser than the pilots' were
    const double judged =
        fastest_frequency(chain, overlaps.head(std::min<Eigen::Index>(overlaps.size(), judged_spheres + 1)));
    relative_tolerance_ = std::clamp(at_one * std::pow(judged * unit, exponent), rounding, coarsest);
    piece_.response = unit * (omega + fastest_decay(chain, overlaps));
    samples_per_unit_ = unit / sample_period_s_;
    horn_.move(piece_);
    piece_.keeps_ledger = options.ledger == LedgerKeeping::on;
    active_at_start_ = options.tracking == WavefrontTracking::on && chain.balanced()
                           ? std::min(chain.bodies(), chain.impact_spheres + laid_out_at_least)
                           : chain.bodies();
    rest_tolerance_ = chain.preload_n > 0 && chain.balanced() ? resolved.scene().numerics.rest_tolerance : 0;
    reset();
}

/// @param scale of the velocities to be expected [m/s]: errors and the threshold of rest are relative to it
void SeriesSolver::judge_by(double scale) noexcept {
    piece_.tolerance = std::max(1e-100, relative_tolerance_ * scale * piece_.unit_s);
    piece_.negligible = negligible_overlap(chain_, piece_.tolerance / piece_.unit_s, piece_.unit_s);
    still_ = still_share * scale;
    const double rest_velocity = rest_tolerance_ * scale;
    rest_energy_ = 0.5 * rest_velocity * rest_velocity / chain_.inv_mass.head(chain_.spheres()).maxCoeff();
}

void SeriesSolver::reset() noexcept {
    judge_by(scale_);
    state_.reset(chain_);
    if (plate_) {
        plate_->reset();
    }
    plate_outputs_.reset();
    lay_out(active_at_start_);
    simd_chain_.contact_events = 0;
    begin_ = end_ = looked_at_ = {};
    last_moment_ = for_good;
    sleeping_ = false;
    next_sample_ = 0;
    ledger_ = {};
    begin_ledger(chain_, state_, ledger_);
    if (delayed_ != nullptr) {
        delayed_->reset({.at = {},
                         .ledger = ledger_,
                         .energy = {kinetic_energy(chain_, state_), stored_energy(chain_, state_, 0)}});
    }
    piece_.length = 0;
    horn_.reset();
    add_work_of_jump(0);
}

const ChainState& SeriesSolver::state(std::size_t /*element*/) noexcept {
    simd_chain_.store(state_);
    return state_;
}

void SeriesSolver::lay_out(Eigen::Index active) noexcept {
    simd_chain_.load(chain_, state_, active);
    kernels_ = kernels::series_kernels(integrator_, simd_chain_.rows(), chain_.damping_law);
    piece_.plate = active == chain_.bodies() ? plate_.get()
                                             : nullptr;  // before the wave is there the plate stands still
    if (piece_.plate != nullptr) {
        plate_->find_slots(simd_chain_);
    }
}

/// A piece carries a disturbance no more bodies far than its series has terms. Where twice as many at the far end of what is laid
/// out stand still, so do the bodies beyond.
void SeriesSolver::follow_the_wave() noexcept {
    const Eigen::Index active = simd_chain_.active();
    if (active == chain_.bodies()) {
        return;
    }
    const double* const x = simd_chain_.column(kernels::ChainField::x);
    const double* const v = simd_chain_.column(kernels::ChainField::v);
    for (Eigen::Index b = active - 2 * Eigen::Index{piece_.degree()}; b < active; ++b) {
        const std::size_t slot = simd_chain_.slot(b);
        if (std::abs(v[slot]) > still_ || std::abs(x[slot]) > still_ * piece_.unit_s) {
            ledger_ = ledger();
            simd_chain_.store(state_);
            lay_out(std::min(chain_.bodies(), active + std::max(laid_out_at_least, active / 8)));
            return;
        }
    }
}

Ledger SeriesSolver::ledger() noexcept {
    Ledger now = ledger_;
    for (std::size_t s = 0; s < simd_chain_.slots(); ++s) {
        now.lost += simd_chain_.column(kernels::ChainField::lost)[s];
    }
    now.work += *simd_chain_.column(kernels::ChainField::work);
    now.gross_work += *simd_chain_.column(kernels::ChainField::gross_work);
    if (plate_) {
        now.passed = plate_->passed;
        now.plate_lost = plate_->lost;
        now.plate_held = plate_->energy();
    }
    return now;
}

/// Books the work of a jump of the horn: the change of the energy stored in contact 0.
void SeriesSolver::add_work_of_jump(double before_m) noexcept {
    const double x = simd_chain_.column(kernels::ChainField::x)[simd_chain_.slot(0)];
    ledger_.add_work(work_of_jump(chain_, x, before_m, piece_.waves.displacement));
}

/// The samples of the delayed chains that show the present piece.
void SeriesSolver::put_delayed(std::int64_t until) noexcept {
    delayed_->put({begin_, end_}, until,
                  [this](EndTapsWriter& writer, ContactForces& contact_forces, const Stretch& later,
                         std::int64_t sample, std::int64_t available) {
                      return samples_.put(writer, kernels_, plate_outputs_, contact_forces, later, sample,
                                          available);
                  });
}

void SeriesSolver::leave_piece() noexcept {
    if (delayed_ != nullptr && state_.step > 0) {
        put_delayed(std::numeric_limits<std::int64_t>::max());
        if (piece_.keeps_ledger) {
            delayed_->note(
                {.at = end_, .ledger = ledger(), .energy = energy(), .contact_events = contact_events()});
        }
    }
    plate_outputs_.leave_piece({begin_, end_});
    if (disc_ != nullptr) {
        disc_->leave_piece(begin_, end_, piece_.plate, piece_.unit_s);
    }
}

void SeriesSolver::next_piece() noexcept {
    leave_piece();
    follow_the_wave();
    begin_ = end_;
    if (const auto before_m = horn_.begin_piece(begin_, state_.step)) {
        add_work_of_jump(*before_m);
    }
    const double left_s = std::min(horn_.left_s(begin_), difference(last_moment_, begin_) * sample_period_s_);
    ++state_.step;
    sleeping_ =
        rest_energy_ > 0 && piece_.waves.silent && energy_above_rest() + plate_energy() <= rest_energy_;
    if (sleeping_) {
        sleep();
        constexpr double longest = 1e15;  // [samples]: for good
        end_.advance(FixedTime::of(std::min(longest, left_s / sample_period_s_)));
        return;
    }
    piece_.reach = std::min(piece_.waves.reach, left_s * piece_.per_unit);
    if (disc_ != nullptr) {
        disc_->expand(begin_, piece_.unit_s, plate_->carried);
    }
    kernels_.piece(simd_chain_, piece_);
    if (chain_.holder_rate > 0 && piece_.keeps_ledger) {
        ledger_.holder_lost += loss_in_holder();
    }
    if (chain_.horn_inv_mass > 0 && piece_.keeps_ledger) {
        horn_.add_energy(ledger_);
    }
    end_.advance(FixedTime::of(piece_.length * samples_per_unit_));
}

/// Over the piece, by the series of the velocities [J].
double SeriesSolver::loss_in_holder() const noexcept {
    constexpr std::size_t nodes = 7;  // exact up to the degree 13; higher terms are small
    constexpr std::size_t together = 8;
    const double* const drag = simd_chain_.column(kernels::ChainField::drag);
    return piece_.per_unit * integral<nodes>(0, piece_.length, [&](double z) {
               double sum = 0;
               for (std::size_t first = 0; first < simd_chain_.slots(); first += together) {
                   const std::size_t count = std::min(together, simd_chain_.slots() - first);
                   std::array<double, together> v{};  // times unit [m]
                   for (int n = piece_.degree(); n > 0; --n) {
                       const double* const terms = piece_.displacement(n) + first;
                       for (std::size_t i = 0; i < count; ++i) {
                           v[i] = v[i] * z + n * terms[i];
                       }
                   }
                   for (std::size_t i = 0; i < count; ++i) {
                       sum += drag[first + i] * v[i] * v[i];
                   }
               }
               return sum;
           });
}

/// Whether the pieces have become so short that time stands still: checked once in max_pieces.
bool SeriesSolver::is_still() noexcept {
    if (state_.step % max_pieces != 0) {
        return false;
    }
    const bool still = difference(end_, looked_at_) < samples_per_unit_;
    looked_at_ = end_;
    return still;
}

/// The next piece, unless a stop is asked for. @returns the status of the motion
Status SeriesSolver::take_piece() noexcept {
    if (options_.stop_asked(state_.step)) {
        return Status::stopped;
    }
    next_piece();
    return !(piece_.largest < 1e300) || is_still() ? Status::unstable : Status::running;
}

/// Of the chain; that of a modal plate's modes is plate_energy().
double SeriesSolver::energy_above_rest() noexcept {
    const ChainState& now = state(0);
    return kinetic_energy(chain_, now) + stored_energy(chain_, now, 0) -
           (ledger_.at_start - ledger_.kinetic_at_start);
}

double SeriesSolver::plate_energy() const noexcept {
    return plate_ ? plate_->energy() : 0;
}

/// Puts the chain and the plate to exact rest; the rest of their motion counts as lost in them.
void SeriesSolver::sleep() noexcept {
    const double left = energy_above_rest();
    ledger_ = ledger();
    ledger_.lost += left;
    state_.reset_motion(chain_);
    lay_out(active_at_start_);
    std::copy_n(simd_chain_.column(kernels::ChainField::closed), simd_chain_.slots(),
                simd_chain_.column(kernels::ChainField::overlap));
    piece_.reset_motion();
    if (plate_) {
        plate_->lost += plate_->energy();
        plate_->rest();
    }
}

bool SeriesSolver::finite() const noexcept {
    double sum = piece_.largest;
    for (std::size_t s = 0; s < simd_chain_.slots(); ++s) {
        sum += std::abs(simd_chain_.column(kernels::ChainField::v)[s]) +
               std::abs(simd_chain_.column(kernels::ChainField::x)[s]);
    }
    return sum < 1e300;
}

Status SeriesSolver::produce(Samples* samples, std::int64_t count) noexcept {
    std::optional<EndTapsWriter> writer;
    if (samples != nullptr) {
        writer.emplace(end_taps_, *samples);
    }
    const std::int64_t end = next_sample_ + count;
    while (next_sample_ < end) {
        // samples k with begin <= k < end lie in the present piece
        const std::int64_t beyond = std::min(end, end_.rounded_up());
        if (next_sample_ < beyond) {
            const std::int64_t available = beyond - next_sample_;
            next_sample_ += writer ? samples_.put(*writer, kernels_, plate_outputs_, contact_forces_,
                                                  {begin_, end_}, next_sample_, available)
                                   : available;
        } else if (const Status status = take_piece(); status != Status::running) {
            return status;
        }
    }
    if (delayed_ != nullptr) {
        put_delayed(end);
    }
    return finite() ? Status::running : Status::unstable;
}

void SeriesSolver::end_at(std::int64_t sample) noexcept {
    last_moment_ = {sample, 0};
    if (sleeping_ && end_.rounded_up() > sample) {
        end_ = last_moment_;
    }
}

Status SeriesSolver::reach_end() noexcept {
    while (difference(last_moment_, end_) >= HornSeries::sliver) {
        if (const Status status = take_piece(); status != Status::running) {
            return status;
        }
    }
    leave_piece();
    return finite() ? Status::running : Status::unstable;
}

Status SeriesSolver::advance_to(FixedTime moment, Samples* samples, std::int64_t count) noexcept {
    last_moment_ = moment;
    Status status = count > 0 ? produce(samples, count) : Status::running;
    while (status == Status::running && difference(last_moment_, end_) >= HornSeries::sliver) {
        status = take_piece();
    }
    if (status == Status::running && disc_ != nullptr) {
        leave_piece();
        begin_ = end_ =
            moment;  // it is left once more when the next one begins, and has nothing to tell then
    }
    return status;
}

void SeriesSolver::join(DiscInWater& disc, double scale) noexcept {
    disc_ = &disc;
    plate_->is_carried = true;
    scale_ = std::max(scale_, scale);
    active_at_start_ = chain_.bodies();
    reset();
}

void SeriesSolver::lead(DelayedChains& chains) noexcept {
    delayed_ = &chains;
    reset();
}

Solver::Energy SeriesSolver::energy() noexcept {
    return {kinetic_energy(chain_, state(0)), stored_energy(chain_, state_, horn_.displacement())};
}

Motion SeriesSolver::motion() noexcept {
    return {.sample = last_moment_.whole,
            .state = state(0),
            .moving = simd_chain_.active(),
            .ledger = ledger(),
            .horn_m = horn_.displacement(),
            .horn_m_per_s = horn_.velocity(),
            .overlaps = simd_chain_.column(kernels::ChainField::overlap),
            .plate = plate_.get(),
            .sound = &plate_outputs_};
}

void SeriesSolver::begin_with(const Motion& motion) noexcept {
    reset();
    state_.take_motion(motion.state);
    // a horn that has become next to silent does not ask for the last digit of the ringing
    constexpr double smallest_share = 1e-6;
    judge_by(std::max(scale_, smallest_share * state_.v.abs().maxCoeff()));
    if (plate_) {
        plate_->continue_from(*motion.plate);
    }
    lay_out(motion.moving);
    // contacts have just closed by their overlaps before
    std::copy_n(motion.overlaps, simd_chain_.slots(), simd_chain_.column(kernels::ChainField::overlap));
    plate_outputs_.continue_from(*motion.sound, motion.sample);
    ledger_ = motion.ledger;
    horn_.continue_from(motion.horn_m, motion.horn_m_per_s);
    add_work_of_jump(motion.horn_m);
}

double SeriesSolver::time_s() const noexcept {
    return (static_cast<double>(end_.whole) + end_.fraction()) * sample_period_s_;
}

std::string SeriesSolver::failure() const {
    const bool still = finite() && piece_.largest < 1e300;
    Eigen::Index contact = 0;
    const double* const overlap = simd_chain_.column(kernels::ChainField::peak_overlap);
    for (Eigen::Index c = 1; c < simd_chain_.active(); ++c) {
        // NaN wins
        if (!(overlap[simd_chain_.slot(c)] <= overlap[simd_chain_.slot(contact)]) &&
            chain_.stiffness[c] > 0) {
            contact = c;
        }
    }
    const double pressed = overlap[simd_chain_.slot(contact)];
    const std::string by =
        std::isfinite(pressed) ? "overlap " + number_text(pressed) + " m" : "its overlap overflowed";
    std::array<char, 320> text{};
    std::snprintf(text.data(), text.size(),
                  "with steps of at most %.4g s the integrator %s after %lld steps, at t = %.6g s (contact "
                  "%lld, %s)",
                  piece_.unit_s, still ? "stalled" : "diverged", static_cast<long long>(state_.step),
                  (static_cast<double>(begin_.whole) + begin_.fraction()) * sample_period_s_,
                  static_cast<long long>(contact), by.c_str());
    return text.data();
}

double SeriesSolver::memory_bytes(double bodies, DampingLaw law) noexcept {
    const double slots = bodies + 64;
    const int rows = kernels::SeriesPiece::rows(kernels::highest_series_degree, law);
    return slots * 8 * (static_cast<double>(kernels::ChainField::count) + rows);
}

}  // namespace hertzline
