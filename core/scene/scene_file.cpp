#include "hertzline/scene_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/scene/text.hpp"
#include "core/scene/toml_entries.hpp"
#include "core/scene/toml_guard.hpp"

namespace hertzline {

namespace {

namespace fs = std::filesystem;

Fault unreadable(const std::string& name, int reason) {
    return {"", "cannot read the scene: " + std::generic_category().message(reason), "", {name}};
}

/// Reads the whole file, or one byte more than is allowed: enough to refuse it.
tl::expected<std::string, Fault> text_of_file(const std::string& name) {
    const auto close = [](std::FILE* file) { std::fclose(file); };
    const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(name.c_str(), "rbe"), close);
    if (file == nullptr) {
        return tl::unexpected(unreadable(name, errno));
    }
    // a little at a time: room for the largest scene would take longer to clear than most scenes to simulate
    std::string text;
    std::array<char, 65536> part{};
    while (text.size() <= max_scene_bytes) {
        const std::size_t wanted = std::min(part.size(), max_scene_bytes + 1 - text.size());
        const std::size_t count = std::fread(part.data(), 1, wanted, file.get());
        text.append(part.data(), count);
        if (count < wanted) {
            break;
        }
    }
    if (std::ferror(file.get()) != 0) {
        return tl::unexpected(unreadable(name, errno));
    }
    if (text.size() > max_scene_bytes) {
        const std::string most = std::to_string(max_scene_bytes) + " bytes";
        return tl::unexpected(Fault{"", "more than " + most, "at most " + most, {name}});
    }
    return text;
}

/// The fault of a name that is neither a file's nor a shipped scene's.
Fault unknown_scene(const std::string& name) {
    std::vector<std::string> shipped;
    for (const ShippedScene& scene : shipped_scenes()) {
        shipped.emplace_back(scene.name);
    }
    const std::string stem = fs::path(name).stem().string();  // "paper-wal.toml" means a shipped one, too
    return {"",
            "no such file or shipped scene",
            "a file, or one of " + comma_separated(shipped) + suggestion(stem, shipped),
            {name}};
}

tl::expected<std::string, Fault> text_of(const std::string& name) {
    std::error_code error;
    const fs::file_status status = fs::status(name, error);
    if (fs::exists(status) && !fs::is_directory(status)) {
        return text_of_file(name);
    }
    if (const ShippedScene* shipped = find_shipped_scene(name)) {
        return std::string(shipped->text);
    }
    if (status.type() == fs::file_type::none) {  // the name itself cannot be looked up
        return tl::unexpected(unreadable(name, error.value()));
    }
    return fs::exists(status) ? text_of_file(name) : tl::unexpected(unknown_scene(name));
}

}  // namespace

tl::expected<ParsedScene, std::vector<Fault>> parse_scene_file(const std::string& name,
                                                               std::span<const std::string> settings) {
    const auto text = text_of(name);
    if (!text) {
        return tl::unexpected(std::vector{text.error()});
    }
    return parse_scene(*text, name, settings);
}

Scene read_scene(const std::string& name) {
    auto parsed = parse_scene_file(name);
    if (!parsed) {
        throw std::invalid_argument(fault_text(parsed.error()));
    }
    return std::move(parsed->scene);
}

}  // namespace hertzline
