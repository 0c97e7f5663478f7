#include "recordings/recorded_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/model/drive.hpp"
#include "core/model/reconstruction.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::recordings {

namespace {

constexpr std::size_t portion_rows = 65'536;

}  // namespace

std::filesystem::path drive_file_of(const std::filesystem::path& recording) {
    const bool sigmf = recording.extension().string().starts_with(".sigmf");
    const std::filesystem::path name = sigmf ? recording.stem() : recording.filename();
    std::filesystem::path file = recording;
    return file.replace_filename(name.string() + "-drive.sigmf-meta");
}

DriveRecorder::DriveRecorder(std::span<const std::filesystem::path> files, const Drive& drive,
                             const std::string& run) {
    const RecordingHead head{.columns = {{.name = "drive", .quantity = "drive", .unit = ""}},
                             .sample_rate_hz = *drive.sample_rate_hz,
                             .numbers = NumberType::float32,
                             .provenance = {{"run", run}}};
    for (const std::filesystem::path& file : files) {
        writers_.push_back(open_recording(file, head));
    }
}

void DriveRecorder::write(std::span<const float> samples) {
    values_.assign(samples.begin(), samples.end());
    complete_ = false;  // unless all of them take it
    for (const auto& writer : writers_) {
        writer->write(next_, values_);
    }
    complete_ = true;
    next_ += static_cast<std::int64_t>(samples.size());
}

bool DriveRecorder::commit() noexcept {
    for (const auto& writer : writers_) {
        try {
            if (next_ == 0) {  // a file needs a sample; that of rest is the first one of any motion
                writer->write(0, std::array{0.0});
            }
            writer->commit();
        } catch (const std::exception&) {
            complete_ = false;
        }
    }
    return complete_;
}

RecordedDrive::RecordedDrive(std::filesystem::path file, const Scene& scene, const std::string& run)
    : file_(std::move(file)), drive_(scene.drive) {
    constexpr double longest_block = 16'384;  // samples that are made before the first of them is given
    kept_s_ = longest_block / scene.output.sample_rate_hz + 2 * reach_beyond_sample_s(scene);
    rewind();
    const RecordingHead& head = reader_->head();
    if (head.columns.size() != 1 || head.sample_rate_hz != *drive_.sample_rate_hz) {
        throw std::runtime_error(fmt::format(
            "{}: {} columns at {:g} Hz, expected the samples of a live drive: one column at {:g} Hz",
            printable_whole(file_.string()), head.columns.size(), head.sample_rate_hz,
            *drive_.sample_rate_hz));
    }
    if (const std::string its = OutsideJson(head.provenance).text("run"); !run.empty() && its != run) {
        throw std::runtime_error(fmt::format("{}: the input of the run {}, expected that of the run {}",
                                             printable_whole(file_.string()),
                                             its.empty() ? "that it does not name" : its, run));
    }
    std::int64_t samples = 0;
    for (RecordedRows rows; reader_->read(rows, portion_rows);) {
        samples += static_cast<std::int64_t>(rows.values.size());
    }
    const double known_s = Reconstruction::known_until_s(samples, *drive_.sample_rate_hz, lowpass_hz(drive_));
    const double until_s = known_s - reach_beyond_sample_s(scene) + drive_.start_s;
    output_samples_ = std::max<std::int64_t>(
        1, static_cast<std::int64_t>(std::ceil(until_s * scene.output.sample_rate_hz - 1e-6)) - 1);
    rewind();
}

void RecordedDrive::rewind() const {
    reader_ = open_reader(file_);
    motion_ = std::make_unique<LiveMotion>(drive_, 2 * kept_s_);
    rows_.values.clear();
    taken_ = 0;
    released_s_ = 0;
    last_ = 0;
}

/// Takes the next portion of samples.
void RecordedDrive::read_on() const {
    if (reader_ && taken_ == rows_.values.size()) {
        taken_ = 0;
        if (!reader_->read(rows_, portion_rows)) {
            reader_.reset();
            rows_.values.clear();
        }
    }
    portion_.assign(LiveMotion::portion, drive_.quantity == DriveQuantity::velocity ? 0 : last_);
    if (reader_) {
        portion_.resize(std::min(LiveMotion::portion, rows_.values.size() - taken_));
        std::transform(rows_.values.begin() + static_cast<std::ptrdiff_t>(taken_),
                       rows_.values.begin() + static_cast<std::ptrdiff_t>(taken_ + portion_.size()),
                       portion_.begin(), [](double value) { return static_cast<float>(value); });
        taken_ += portion_.size();
        last_ = portion_.back();
    }
    motion_->append(portion_);
}

const Polynomial& RecordedDrive::at(double time_s) const noexcept {
    try {
        if (time_s < released_s_) {
            rewind();
        }
        while (failure_.empty() && motion_->known_until_s() <= time_s) {
            if (!motion_->has_room()) {
                released_s_ = std::max(0.0, motion_->known_until_s() - kept_s_);
                motion_->release(released_s_);
            }
            read_on();
        }
    } catch (const std::exception& error) {
        failure_ = error.what();
    }
    return motion_->at(time_s);
}

}  // namespace hertzline::recordings
