#pragma once

#include <span>
#include <string_view>

namespace hertzline::scope {

/// A file of the page, which is part of the program.
struct PageFile {
    std::string_view name;  ///< "index.html"
    std::string_view type;  ///< "text/html; charset=utf-8"
    std::string_view text;
};

/// The files of apps/scope/. index.html stands for the page itself.
std::span<const PageFile> page_files() noexcept;

}  // namespace hertzline::scope
