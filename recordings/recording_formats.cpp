#include "recordings/recording_formats.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "core/scene/faults.hpp"
#include "core/scene/text.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/formats/csv/csv.hpp"
#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/npy.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/formats/wav.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

using Writer = std::unique_ptr<RecordingWriter>;

/// For formats that have their name only when they are complete.
template <Writer (*open)(const fs::path&, const RecordingHead&)>
Writer when_complete(const fs::path& path, const RecordingHead& head, Appearance /*appearance*/) {
    return open(path, head);
}

struct Format {
    std::string_view ending;
    double bytes_per_number;                                             // upper bound
    Writer (*write)(const fs::path&, const RecordingHead&, Appearance);  // nullptr: only read
    std::unique_ptr<RecordingReader> (*read)(const fs::path&, const ReadOptions&);
};

constexpr std::array formats{
    Format{".csv", 24, when_complete<open_csv_writer>,
           open_csv_reader},  // 17 digits, sign, point, exponent, comma
    Format{sigmf_meta_ending, 4, open_sigmf_writer, open_sigmf_reader},
    Format{sigmf_data_ending, 4, open_sigmf_writer, open_sigmf_reader},
    Format{sigmf_collection_ending, 4, open_sigmf_collection_writer, open_sigmf_collection_reader},
    Format{sigmf_archive_ending, 4, nullptr, open_sigmf_archive_reader},
    Format{".h5", 8, when_complete<open_hdf5_writer>, open_hdf5_reader},
    Format{".wav", 4, when_complete<open_wav_writer>, open_wav_reader},
    Format{".npy", 8, when_complete<open_npy_writer>, open_npy_reader},
};

/// nullptr for an unknown ending.
const Format* format_of(const fs::path& path) {
    const std::string ending = recording_ending(path);
    std::error_code unknown;  // a name that cannot be asked about is no device
    const bool device = fs::is_character_file(path, unknown) || fs::is_fifo(path, unknown);
    const std::string_view wanted = ending.empty() && device ? ".csv" : std::string_view(ending);
    const auto* const found = std::ranges::find(formats, wanted, &Format::ending);
    return found != formats.end() ? found : nullptr;
}

bool is_allowed(const Format& format, Access access) {
    return access == Access::reading || format.write != nullptr;
}

const Format& format_or_refuse(const fs::path& path, Access access) {
    throw_if(recording_fault(path, access));
    return *format_of(path);
}

}  // namespace

std::string recording_ending(const fs::path& path) {
    return lower_case(path.extension().string());
}

std::string recording_endings(Access access) {
    std::string endings;
    for (const Format& format : formats) {
        if (is_allowed(format, access)) {
            endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
        }
    }
    return endings;
}

std::optional<std::string> recording_fault(const fs::path& path, Access access) {
    const Format* const format = format_of(path);
    if (format != nullptr && is_allowed(*format, access)) {
        return std::nullopt;
    }
    return printable_whole(path.string()) + ": found the ending " + quoted_briefly(recording_ending(path)) +
           ", allowed: " + recording_endings(access);
}

fs::path recording_name(const fs::path& path) {
    return (recording_ending(path) == sigmf_data_ending ? sigmf_paths(path).meta : path).lexically_normal();
}

bool share_files(const fs::path& one, const fs::path& other) {
    const fs::path a = recording_name(one);
    const fs::path b = recording_name(other);
    const auto is_same = [](const fs::path& x, const fs::path& y) {
        std::error_code one_is_missing;
        return x == y || fs::equivalent(x, y, one_is_missing);
    };
    const auto folder = [](const fs::path& file) {
        return file.has_parent_path() ? file.parent_path() : ".";
    };
    const auto is_member = [&](const fs::path& file, const fs::path& collection) {
        return recording_ending(collection) == sigmf_collection_ending &&
               recording_ending(file) == sigmf_meta_ending &&
               file.stem().string().starts_with(collection.stem().string() + '-') &&
               is_same(folder(file), folder(collection));
    };
    const bool named_otherwise = a != one || b != other;
    return is_same(a, b) || (named_otherwise && is_same(one, other)) || is_member(a, b) || is_member(b, a);
}

std::optional<std::string> repeated_fault(const std::string& file, std::span<const std::string> before) {
    const auto twin =
        std::ranges::find_if(before, [&](const std::string& other) { return share_files(file, other); });
    if (twin == before.end()) {
        return std::nullopt;
    }
    return printable(file) + ": found files of " + printable(*twin) + ", allowed: each file once";
}

std::vector<std::string> recordings_faults(std::span<const std::string> files) {
    std::vector<std::string> faults;
    for (std::size_t i = 0; i < files.size(); ++i) {
        const auto fault = recording_fault(files[i]);
        if (const auto found = fault ? fault : repeated_fault(files[i], files.first(i))) {
            faults.push_back(*found);
        }
    }
    return faults;
}

double recording_bytes(const fs::path& path, double columns, double samples) noexcept {
    constexpr double time_column = 1;  // in formats that have one
    const Format* format = format_of(path);
    return format != nullptr ? samples * (columns + time_column) * format->bytes_per_number : 0;
}

void require_writable(const fs::path& path) {
    std::error_code unknown;
    if (fs::is_directory(path, unknown)) {
        throw std::runtime_error("cannot write " + printable(path.string()) + ": it is a folder");
    }
    if (!fs::exists(path, unknown) || fs::is_regular_file(path, unknown)) {
        const OutputFile writable(path);
    }
}

std::unique_ptr<RecordingWriter> open_recording(const fs::path& path, const RecordingHead& head,
                                                Appearance appearance) {
    return format_or_refuse(path, Access::writing).write(path, head, appearance);
}

std::unique_ptr<RecordingReader> open_reader(const fs::path& path, const ReadOptions& options) {
    return format_or_refuse(path, Access::reading).read(path, options);
}

}  // namespace hertzline::recordings
