#pragma once
// A picture of samples: waveform and spectrum of each column, drawn by a script in Python (apps/plot).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "recordings/files/staged_file.hpp"
#include "recordings/recording.hpp"

namespace hertzline::app {

/// What a picture is drawn of, at most, give or take a portion of samples.
inline constexpr std::size_t max_picture_columns = 6;
inline constexpr std::int64_t max_picture_samples = std::int64_t{1} << 20;

/// @param option that names the picture @throws WrongUse unless its ending is that of a picture
void refuse_wrong_picture(const char* option, const std::filesystem::path& picture);

/// Takes samples, then draws them. To be used while stop_asked() notes signals: it leaves nothing that is not complete.
class Picture {
public:
    /// @param head of the samples, at most max_picture_columns @throws std::runtime_error when nothing can be written there
    Picture(const std::filesystem::path& picture, const recordings::RecordingHead& head);
    ~Picture();
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    /// As RecordingWriter::write().
    void write(std::int64_t first, std::span<const double> values);

    /// Draws the picture and gives it its name. False, and there is none, when stopped meanwhile.
    /// @throws std::runtime_error that says what is missing or wrong
    bool draw(const std::string& title);

private:
    std::string format_;  // "png"
    recordings::StagedFile file_;
    std::filesystem::path folder_;  // temporary
    std::unique_ptr<recordings::RecordingWriter> samples_;
};

/// How a picture went. stopped: the user asked to, and there is none.
enum class Drawn { yes, stopped, no_sweep };

/// Draws a table of `hertzline sweep`: the quantities over what varies; none: the usual ones. To be used as Picture.
/// @throws std::runtime_error that says what is missing or wrong
Drawn draw_sweep(const std::filesystem::path& picture, const std::filesystem::path& table,
                 std::span<const std::string> quantities, const std::string& title);

}  // namespace hertzline::app
