#pragma once
// Pictures of recordings and of sweeps, drawn by a script in Python (apps/plot).

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/commands/plot/outline.hpp"
#include "recordings/recording.hpp"

namespace hertzline::app {

/// The text of apps/plot/hertzline_plot.py, which is part of the program.
extern const char* const plot_script;

/// The most panels of a picture.
inline constexpr std::size_t max_picture_panels = 6;

/// Returns the columns that a picture of one recording shows. All spheres of a chain share a panel. @param chosen those asked for
std::vector<std::size_t> columns_in_picture(const recordings::RecordingHead& head,
                                            std::span<const std::size_t> chosen);

/// Returns the fault of a file whose ending is not that of a picture.
std::optional<std::string> picture_fault(const std::filesystem::path& picture);

/// The outcome of a picture. stopped: on the user's request, without a picture.
enum class Drawn { yes, stopped, no_sweep };

/// A recording as it is drawn. Several of them share their panels.
struct RecordingOutline {
    std::string name;                ///< in the legend
    recordings::RecordingHead head;  ///< its columns are those of the outline
    Outline outline;
};

/// Draws waveforms and spectra. Use it while stop_asked() notes signals: it leaves no incomplete picture.
/// @throws std::runtime_error with the fault
Drawn draw_recordings(const std::filesystem::path& picture, std::span<const RecordingOutline> drawn,
                      const std::string& title);

/// The parts of a sweep that are drawn; none: the usual numbers.
struct SweepChoice {
    std::vector<std::string> quantities;  ///< numbers, over the varied keys
    std::vector<std::string> waveforms;   ///< outputs whose samples the table holds; in place of numbers
};

/// Draws a table of `hertzline sweep`. Use it like draw_recordings().
/// @throws WrongUse where the table has no such numbers, std::runtime_error with any other fault
Drawn draw_sweep(const std::filesystem::path& picture, const std::filesystem::path& table,
                 const SweepChoice& choice, const std::string& title);

}  // namespace hertzline::app
