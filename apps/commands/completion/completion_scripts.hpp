#pragma once
// The scripts with which shells complete command lines. Apart from completion.hpp, whose libraries take longer to read than these.

#include <span>
#include <string_view>

namespace hertzline::app {

struct CompletionScript {
    std::string_view shell;  ///< "bash"
    std::string_view text;
};

/// Defined in a file that apps/CMakeLists.txt writes from apps/completion.
extern const std::span<const CompletionScript> completion_scripts;

}  // namespace hertzline::app
