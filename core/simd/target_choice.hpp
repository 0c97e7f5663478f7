#pragma once
// Which instruction sets kernels can use here, and which they do.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hertzline::kernels {

/// Highway's bit of the target that kernels use.
std::int64_t chosen_target() noexcept;

/// The names that kernel_target() can have on this processor, the widest first.
const std::vector<std::string>& kernel_targets();

/// From here on all kernels use these instructions, as they would on a processor that has no wider ones. Not while another thread uses
/// kernels. @returns false, and nothing has changed, when the name is none of kernel_targets()
bool pin_kernel_target(std::string_view name);

}  // namespace hertzline::kernels
