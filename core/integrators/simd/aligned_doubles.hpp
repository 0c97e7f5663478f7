#pragma once
// Room for the numbers that kernels load into vector registers.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace hertzline::kernels {

inline constexpr std::size_t register_bytes = 64;  ///< of the widest vector register

struct FreeAligned {
    void operator()(double* p) const noexcept { ::operator delete[](p, std::align_val_t{register_bytes}); }
};

/// An array that begins where a vector register can be loaded from.
using AlignedDoubles = std::unique_ptr<double[], FreeAligned>;

/// @throws std::bad_alloc
inline AlignedDoubles aligned_zeros(std::size_t count) {
    AlignedDoubles room(
        static_cast<double*>(::operator new[](count * sizeof(double), std::align_val_t{register_bytes})));
    std::fill_n(room.get(), count, 0.0);
    return room;
}

}  // namespace hertzline::kernels
