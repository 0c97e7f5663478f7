#pragma once
// Samples as SigMF (github.com/sigmf/SigMF, version 1.2): float32, sample after sample, in x.sigmf-data, and their
// description as JSON in x.sigmf-meta.
//
// A capture begins where samples are missing: core:sample_start is its first sample in the file,
// core:global_index that sample's number in the run, core:datetime the time at which it was written. Columns
// and provenance have names of the namespace "hertzline".
//
// Each burst of the horn has an annotation, "burst 12", over the samples up to the next burst, for the first 1000
// bursts in the file; while it is written, for complete bursts.
//
// Viewers take interleaved channels for a single one. A SigMF collection (x.sigmf-collection) has a recording of one
// channel for each column, x-COLUMN.sigmf-meta and x-COLUMN.sigmf-data, all of the same samples, and lists them with
// the SHA-512 of their metadata, as the specification demands.
//
// The files are whole at any time, so that the recording survives the sudden end of the program: data go to
// the system at least once in half a second, and a capture becomes known before its first sample.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

#include "recordings/recording.hpp"

namespace hertzline::recordings {

inline constexpr std::string_view sigmf_meta_ending = ".sigmf-meta";
inline constexpr std::string_view sigmf_data_ending = ".sigmf-data";
inline constexpr std::string_view sigmf_collection_ending = ".sigmf-collection";
inline constexpr std::string_view sigmf_archive_ending = ".sigmf";  ///< read, not written

/// The specification's maximum.
inline constexpr std::size_t sigmf_max_channels = 1000;

/// The two files of a SigMF recording.
struct SigmfPaths {
    std::filesystem::path meta;
    std::filesystem::path data;
};

/// Returns both files of a recording, from the name of one.
SigmfPaths sigmf_paths(const std::filesystem::path& either);

/// Replaces a recording of that name with its first row, or with commit(). After the first row the file stays valid,
/// whatever happens.
std::unique_ptr<RecordingWriter> open_sigmf_writer(const std::filesystem::path& either,
                                                   const RecordingHead& head,
                                                   Appearance appearance = Appearance::early);

/// Begins a collection, with a recording for each column. Files with a column's name are replaced, too. While it is
/// written the hashes may lag behind the metadata for a moment. At most 100 columns: each has files of its own.
std::unique_ptr<RecordingWriter> open_sigmf_collection_writer(const std::filesystem::path& collection,
                                                              const RecordingHead& head,
                                                              Appearance appearance = Appearance::early);

/// Reads recordings of any type and number of channels (integers as in file_numbers.hpp; a complex channel makes two
/// columns), with datasets of other formats, and refuses samples with another core:sha512 than theirs. Half a sample at the
/// end, which a kill in the midst of writing may leave, is passed over.
std::unique_ptr<RecordingReader> open_sigmf_reader(const std::filesystem::path& either,
                                                   const ReadOptions& options = {});

/// Reads an archive with one recording.
std::unique_ptr<RecordingReader> open_sigmf_archive_reader(const std::filesystem::path& archive,
                                                           const ReadOptions& options = {});

/// Reads a collection whose recordings have one rate and the same samples, up to the end of the shortest: a kill may
/// leave them of different lengths. Hashes are not checked, because annotating a recording changes them.
std::unique_ptr<RecordingReader> open_sigmf_collection_reader(const std::filesystem::path& collection,
                                                              const ReadOptions& options = {});

}  // namespace hertzline::recordings
