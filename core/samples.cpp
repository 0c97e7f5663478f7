#include "core/samples.hpp"

namespace hertzline {

Samples::Samples(TapSet taps, std::size_t spheres, std::size_t capacity)
    : capacity_(capacity), spheres_(spheres), taps_(taps) {
    for (const Tap tap : taps) {
        columns_[static_cast<std::size_t>(tap)].resize(capacity * channels_of(tap, spheres));
    }
}

}  // namespace hertzline
