#pragma once
// Under a sanitizer a step takes ten times as long, so tests with repetitions over random inputs or ranges repeat less.

namespace hertzline::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// Returns the number of repetitions: a tenth under a sanitizer.
template <class Count>
constexpr Count repeated(Count count) noexcept {
    return sanitized ? count / 10 : count;
}

}  // namespace hertzline::test
