#pragma once
// Pictures of recordings, sweeps and fields, drawn by a script in Python (apps/plot).

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/commands/plot/outline.hpp"
#include "recordings/recording.hpp"
#include "studies/field.hpp"

namespace hertzline::app {

/// The most panels of a picture.
inline constexpr std::size_t max_picture_panels = 6;

/// Returns the columns that a picture of one recording shows. All spheres of a chain share a panel. @param chosen those asked for
std::vector<std::size_t> columns_in_picture(const recordings::RecordingHead& head,
                                            std::span<const std::size_t> chosen);

/// The endings of pictures that do not move.
inline constexpr std::array still_endings{".png", ".svg", ".pdf"};

/// Returns the fault of a file whose ending is not one of these.
std::optional<std::string> picture_fault(const std::filesystem::path& picture,
                                         std::span<const char* const> endings = still_endings);

/// The outcome of a picture. stopped: on the user's request, without a picture.
enum class Drawn { yes, stopped, no_sweep };

/// A recording as it is drawn. Several of them share their panels.
struct RecordingOutline {
    std::string name;                ///< in the legend
    recordings::RecordingHead head;  ///< its columns are those of the outline
    Outline outline;
    /// Where bands begin [Hz]; unset: at half the drive's frequency.
    std::optional<double> band_from_hz = {};
};

/// Draws waveforms and spectra. Use it while stop_asked() notes signals: it leaves no incomplete picture.
/// @throws std::runtime_error with the fault
Drawn draw_recordings(const std::filesystem::path& picture, std::span<const RecordingOutline> drawn,
                      const std::string& title);

/// The times that are drawn [s].
struct Window {
    double from_s = 0;
    double to_s = std::numeric_limits<double>::infinity();
};

/// The view of a field.
struct FieldView {
    std::string kind;                ///< one of the script's; empty: the usual one
    std::vector<studies::Point> at;  ///< points of spectra; none: that of the largest peak
    Window window;
    std::optional<int> frames;  ///< of a movie; none: some of each period of the drive
};

/// The parts of a table that are drawn; none: the usual numbers.
struct SweepChoice {
    std::vector<std::string> quantities;  ///< numbers, over the varied keys
    std::vector<std::string> waveforms;   ///< outputs whose samples the table holds; in place of numbers
    FieldView view;
};

/// Draws a table of `hertzline sweep` or `hertzline field`. Use it like draw_recordings().
/// @throws WrongUse where the table has no such numbers, std::runtime_error with any other fault
Drawn draw_sweep(const std::filesystem::path& picture, const std::filesystem::path& table,
                 const SweepChoice& choice, const std::string& title);

}  // namespace hertzline::app
