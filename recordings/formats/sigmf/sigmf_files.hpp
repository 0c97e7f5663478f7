#pragma once
// The two files of a SigMF recording while they are written, some of a run's columns in them.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "recordings/files/growing_file.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/recording.hpp"

#include "core/scene/json.hpp"

namespace hertzline::recordings {

/// The version that is written.
inline constexpr const char* sigmf_version = "1.2.0";

/// What SigMF says of the namespace "hertzline".
Json sigmf_extensions();

/// As SigMF files have it.
std::string sigmf_text(const Json& json);

/// What changes in the metadata while samples are written.
struct SigmfProgress {
    Json captures = Json::array();
    Json annotations = Json::array();
};

/// Metadata and samples. Errors are those of their files.
class SigmfFiles {
public:
    /// Fails now or not at all, as far as that can be known. Nothing is replaced yet.
    /// @param columns those of the head that are in these files, in order
    SigmfFiles(const SigmfPaths& paths, const RecordingHead& head, std::vector<std::size_t> columns);

    /// Says in the metadata, before they are saved, that the recording belongs to a collection of that name.
    void name_collection(const std::string& name) { global_["core:collection"] = name; }

    /// The same of a change of the scene, the last of "changes".
    void name_change(const Json& change) { global_["hertzline:changes"].push_back(change); }

    /// Takes the place of what had the name. Old metadata go first and new ones come last: they never lie beside
    /// samples that are not theirs.
    void appear(const SigmfProgress& progress);

    void save_meta(const SigmfProgress& progress);

    /// @param values whole rows of all columns of the head @param make_room called where the buffer has none for them
    void write(std::span<const double> values, const std::function<void()>& make_room);
    void flush() { data_.flush(); }
    void commit() { data_.commit(); }
    /// Ends the samples. What had the name is still there.
    void close() { data_.close(); }
    bool is_closed() const noexcept { return data_.is_closed(); }
    /// Whether the system failed to close the samples: what is in the file is not known.
    bool is_doubtful() const noexcept { return data_.is_doubtful(); }
    /// Fails when the samples have been removed, or replaced by those of another recording.
    void require_present() { data_.require_present(); }

    /// Rows that the system has taken.
    std::int64_t rows() const noexcept { return data_.records(); }

    /// Ends them before they are complete; those without a name of their own stay under the names of their temporaries.
    /// @returns where the samples are
    std::filesystem::path keep(const SigmfProgress& progress);

    void remove() noexcept;

    /// As a collection lists them: name, and hash of the metadata that were saved last.
    Json listed() const;

private:
    std::string meta_text(const SigmfProgress& progress) const;

    std::filesystem::path meta_path_;
    GrowingFile data_;
    std::vector<std::size_t> columns_;
    std::size_t all_columns_;
    Json global_;
    std::string hash_;  // empty: none are saved
    std::vector<float> floats_;
    bool appeared_ = false;
};

}  // namespace hertzline::recordings
