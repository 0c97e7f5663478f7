#pragma once
// The samples of a live drive, in a file beside the recordings of its stream.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/live_motion.hpp"
#include "hertzline/scene.hpp"
#include "recordings/recording.hpp"

namespace hertzline::recordings {

/// The file of the samples, beside the recording: out.h5-drive.sigmf-meta for out.h5, out-drive.sigmf-meta for SigMF's out.
std::filesystem::path drive_file_of(const std::filesystem::path& recording);

/// Writes them.
class DriveRecorder {
public:
    /// @param drive live, with its rate @param run the stream's id @throws std::runtime_error that names the path and the reason
    DriveRecorder(std::span<const std::filesystem::path> files, const Drive& drive, const std::string& run);

    /// @throws std::runtime_error
    void write(std::span<const float> samples);
    /// Completes the files. @returns whether they hold all samples
    bool commit() noexcept;

private:
    std::vector<std::unique_ptr<RecordingWriter>> writers_;
    std::vector<double> values_;
    std::int64_t next_ = 0;
    bool complete_ = true;
};

/// Their motion, read as a simulation goes on: from the start to the end, once or several times. After the last sample the horn
/// stays where it is. For one simulation.
class RecordedDrive final : public PiecewiseMotion {
public:
    /// @param scene resolved, with a live drive whose file this is @param run that it is of; empty: not known
    /// @throws std::runtime_error that names the path and the reason
    RecordedDrive(std::filesystem::path file, const Scene& scene, const std::string& run);

    /// Samples of the output that the file's samples are enough for.
    std::int64_t output_samples() const noexcept { return output_samples_; }

    const Polynomial& at(double time_s) const noexcept override;
    /// Why it could not be read to its end; empty: it could.
    std::string failure() const { return failure_; }

private:
    void rewind() const;
    void read_on() const;

    std::filesystem::path file_;
    Drive drive_;
    double kept_s_;  ///< how far a simulation looks back
    std::int64_t output_samples_ = 0;
    // reading on changes nothing that can be seen
    mutable std::unique_ptr<RecordingReader> reader_;
    mutable std::unique_ptr<LiveMotion> motion_;
    mutable RecordedRows rows_;
    mutable std::vector<float> portion_;
    mutable std::size_t taken_ = 0;  ///< of the rows
    mutable double released_s_ = 0;
    mutable float last_ = 0;
    mutable std::string failure_;
};

}  // namespace hertzline::recordings
