#pragma once
// Under a sanitizer a step takes ten times as long: tests that repeat themselves for the sake of chance or range repeat less there.

namespace hertzline::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// How often: a tenth of it under a sanitizer.
template <class Count>
constexpr Count repeated(Count count) noexcept {
    return sanitized ? count / 10 : count;
}

}  // namespace hertzline::test
