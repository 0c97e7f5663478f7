#include "recordings/files/errors.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "core/scene/text.hpp"

namespace hertzline::recordings {

void cannot_write(const std::filesystem::path& path, std::string_view reason) {
    throw std::runtime_error(fmt::format("cannot write {}: {}", path.string(), reason));
}

void cannot_read(const std::filesystem::path& path, std::string_view reason) {
    constexpr std::size_t max_length = 300;  // it may quote the file
    throw std::runtime_error(fmt::format("cannot read {}: {}", path.string(), printable(reason, max_length)));
}

}  // namespace hertzline::recordings
