// The horn's motion as a power series. Included once per SIMD target.
#if defined(HERTZLINE_HORN_SERIES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HERTZLINE_HORN_SERIES_INL
#undef HERTZLINE_HORN_SERIES_INL
#else
#define HERTZLINE_HORN_SERIES_INL
#endif

#include "core/integrators/series_piece.hpp"
#include "core/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hertzline::kernels {
namespace HWY_NAMESPACE {

/// The horn's series where the piece begins.
HWY_INLINE void expand_horn(SeriesPiece& piece) {
    const Doubles d;
    const HornWaves& waves = piece.waves;
    for (std::size_t n = 0; n < HornWaves::pairs; n += lanes()) {
        Vec even = splat(waves.sine[0]) * hn::LoadU(d, waves.even[0].data() + n);
        Vec odd = splat(waves.cosine[0]) * hn::LoadU(d, waves.odd[0].data() + n);
        for (std::size_t i = 1; i < 3; ++i) {
            even = MulAdd(splat(waves.sine[i]), hn::LoadU(d, waves.even[i].data() + n), even);
            odd = MulAdd(splat(waves.cosine[i]), hn::LoadU(d, waves.odd[i].data() + n), odd);
        }
        hn::StoreInterleaved2(even, odd, d, piece.horn.data() + 2 * n);
    }
}

/// Sines and cosines at z, by the addition theorems.
HWY_INLINE void turn_horn(HornWaves& waves, double z) {
    using Waves = hn::CappedTag<double, HornWaves::count>;
    constexpr Waves d;
    const auto zz = hn::Set(d, z);
    const auto square = zz * zz;
    auto displacement = hn::Zero(d);
    auto slope = hn::Zero(d);
    for (std::size_t i = 0; i < HornWaves::count; i += hn::Lanes(d)) {
        auto even = hn::Load(d, waves.even_by_pair[HornWaves::pairs - 1].data() + i);
        auto odd = hn::Load(d, waves.odd_by_pair[HornWaves::pairs - 1].data() + i);
        for (std::size_t pair = HornWaves::pairs - 1; pair-- > 0;) {
            even = MulAdd(even, square, hn::Load(d, waves.even_by_pair[pair].data() + i));
            odd = MulAdd(odd, square, hn::Load(d, waves.odd_by_pair[pair].data() + i));
        }
        odd = odd * zz;
        const auto sine = hn::Load(d, waves.sine.data() + i);
        const auto cosine = hn::Load(d, waves.cosine.data() + i);
        const auto later_sine = MulAdd(sine, even, cosine * odd);
        const auto later_cosine = MulSub(cosine, even, sine * odd);
        hn::Store(later_sine, d, waves.sine.data() + i);
        hn::Store(later_cosine, d, waves.cosine.data() + i);
        displacement = displacement + later_sine;
        slope = MulAdd(later_cosine, hn::Load(d, waves.odd_by_pair[0].data() + i), slope);
    }
    waves.displacement = GetLane(hn::SumOfLanes(d, displacement));
    waves.slope = GetLane(hn::SumOfLanes(d, slope));
}

}  // namespace HWY_NAMESPACE
}  // namespace hertzline::kernels
HWY_AFTER_NAMESPACE();

#endif
