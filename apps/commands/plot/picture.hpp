#pragma once
// A picture of samples: waveform and spectrum of each column, drawn by a script in Python (apps/plot).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "recordings/files/staged_file.hpp"
#include "recordings/recording.hpp"

namespace hertzline::app {

/// The text of apps/plot/hertzline_plot.py, which is part of the program.
extern const char* const plot_script;

/// The most samples that a picture is drawn of, to within a portion.
inline constexpr std::size_t max_picture_columns = 6;
inline constexpr std::int64_t max_picture_samples = std::int64_t{1} << 20;

/// Returns the fault of a file whose ending is not that of a picture.
std::optional<std::string> picture_fault(const std::filesystem::path& picture);

/// Takes samples, then draws them. Use it while stop_asked() notes signals: it leaves no incomplete picture.
class Picture {
public:
    /// @param head of the samples, at most max_picture_columns @throws std::runtime_error when nothing can be written there
    Picture(const std::filesystem::path& picture, const recordings::RecordingHead& head);
    ~Picture();
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    /// Takes rows as RecordingWriter::write() does.
    void write(std::int64_t first, std::span<const double> values);

    /// Draws the picture and gives it its name. Returns false, without a picture, when stopped meanwhile.
    /// @throws std::runtime_error with the fault
    bool draw(const std::string& title);

private:
    std::string format_;  // "png"
    recordings::StagedFile file_;
    std::filesystem::path folder_;  // temporary
    std::unique_ptr<recordings::RecordingWriter> samples_;
};

/// The outcome of a picture. stopped: on the user's request, without a picture.
enum class Drawn { yes, stopped, no_sweep };

/// Draws a table of `hertzline sweep`: the quantities over the varied keys; none: the usual ones. Use it like Picture.
/// @throws std::runtime_error with the fault
Drawn draw_sweep(const std::filesystem::path& picture, const std::filesystem::path& table,
                 std::span<const std::string> quantities, const std::string& title);

}  // namespace hertzline::app
