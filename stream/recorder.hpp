#pragma once
// Samples to a file, at full precision. The file's ending picks the format; CSV so far.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/simulation.hpp"
#include "stream/csv.hpp"
#include "stream/output_file.hpp"

namespace hertzline {

/// What a recording holds beside the outputs.
enum class RecordedBodies { outputs, all };

/// Why a file of that name cannot be recorded to (unknown ending); nothing when it can.
std::optional<std::string> recording_fault(const std::filesystem::path& path);

/// Bytes of a recording, from above: so that a full disk is noticed before the run.
double recording_bytes(const Scene& scene, double samples, RecordedBodies bodies) noexcept;

class Recorder {
public:
    /// Opens the file. Throws std::runtime_error that names the path and the reason.
    Recorder(const std::filesystem::path& path, const Chain& chain, double sample_rate_hz,
             RecordedBodies bodies);

    /// Appends a block that holds the outputs (and for RecordedBodies::all the whole chain). Throws like
    /// above.
    void write(const Samples& block);

    /// Completes the file and gives it its name; without this nothing is left behind.
    void commit() { file_.commit(); }

    const std::filesystem::path& path() const noexcept { return file_.path(); }

private:
    double sample_rate_hz_;
    RecordedBodies bodies_;
    OutputFile file_;
    CsvWriter csv_;
    std::vector<double> row_;
};

}  // namespace hertzline
