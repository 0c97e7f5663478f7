#pragma once
// The two files of a SigMF recording while they are written, some of a run's columns in them; the checks of names and hashes that its
// readers share.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/json.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/formats/sigmf/sigmf_archive.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// The version that is written.
inline constexpr const char* sigmf_version = "1.2.0";

/// SigMF's declaration of the namespace "hertzline".
Json sigmf_extensions();

/// JSON in the form of SigMF files.
std::string sigmf_text(const Json& json);

/// Entries of a list in the metadata, as text, so that earlier entries are not formatted again.
class SigmfList {
public:
    /// @param depth of the list in the metadata
    explicit SigmfList(int depth) : indent_(2 * static_cast<std::size_t>(depth), ' ') {}

    void add(const Json& entry);
    /// Takes the last add() back; only once.
    void drop_last() { text_.resize(before_last_); }
    void clear() { text_.clear(); }
    std::size_t size() const noexcept { return text_.size(); }
    /// The list as JSON.
    std::string text() const;

private:
    std::string indent_;
    std::string text_;
    std::size_t before_last_ = 0;
};

/// Whether the text may name a file beside a SigMF file: UTF-8 of at most 255 bytes, without folders and control characters.
bool names_a_neighbour(const std::string& text);

/// Returns the SHA-512 of a part of a file in hexadecimal digits; nothing once `stop` is true (null: never). Leaves the file at its end.
std::optional<std::string> sha512_of(InputFile& file, const ArchivedFile& part,
                                     const std::atomic<bool>* stop);

/// Compares the hash of a file with the one in the metadata, if there is one. Returns how they differ.
/// @param told_hash that of the metadata; "": none @param stop true: nothing is compared
std::optional<std::string> hash_fault(std::string_view told_hash, InputFile& file, const ArchivedFile& part,
                                      const std::atomic<bool>* stop);

/// The part of the metadata that changes while samples are written.
struct SigmfProgress {
    SigmfList captures{1};
    SigmfList annotations{1};
    SigmfList changes{2};
    bool may_change = false;              ///< the scene, so the changes are listed
    std::int64_t changes_until_sample{};  ///< all before it are listed

    std::size_t size() const noexcept { return captures.size() + annotations.size() + changes.size(); }
};

/// Metadata and samples. Errors are those of their files.
class SigmfFiles {
public:
    /// Fails now or not at all, as far as that can be known. Nothing is replaced yet.
    /// @param columns those of the head that are in these files, in order
    SigmfFiles(const SigmfPaths& paths, const RecordingHead& head, std::vector<std::size_t> columns);

    /// Marks the recording as part of a collection of that name; call it before the metadata are saved.
    void name_collection(const std::string& name) { global_["core:collection"] = name; }

    /// Replaces an older recording. Old metadata go first and new ones come last: they never lie beside
    /// samples that are not theirs.
    void appear(const SigmfProgress& progress);

    void save_meta(const SigmfProgress& progress);

    /// @param values whole rows of all columns of the head @param make_room called where the buffer has none for them
    void write(std::span<const double> values, const std::function<void()>& make_room);
    void flush();
    void commit() { data_.commit(); }
    /// Ends the samples. An older recording is still there.
    void close();
    bool is_closed() const noexcept { return data_.is_closed(); }
    /// Whether the system failed to close the samples, so that the file's contents are unknown.
    bool is_doubtful() const noexcept { return data_.is_doubtful(); }
    /// Fails when the samples have been removed, or replaced by those of another recording.
    void require_present() { data_.require_present(); }

    /// Rows that the system has taken.
    std::int64_t rows() const noexcept;

    /// Ends them before they are complete; those without a name of their own stay under the names of their temporaries.
    /// @returns where the samples are
    std::filesystem::path keep(const SigmfProgress& progress);

    void remove() noexcept;

    /// The entry of a collection: name, and hash of the last saved metadata.
    Json listed() const;

private:
    std::string meta_text(const SigmfProgress& progress) const;

    std::filesystem::path meta_path_;
    OutputFile data_;
    std::vector<std::size_t> columns_;
    std::size_t all_columns_;
    Json global_;       // without the changes
    std::string hash_;  // empty: none are saved
    std::vector<float> floats_;
    bool appeared_ = false;
};

}  // namespace hertzline::recordings
