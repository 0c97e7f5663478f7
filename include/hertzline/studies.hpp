#pragma once
// Studies: a scene with many values of some keys, simulated on all processors. A sweep runs every point; a search looks for the best.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "hertzline/run.hpp"
#include "hertzline/scene.hpp"

namespace hertzline {

/// The values of a key in a study: a list, or a text as `--vary` has it after "KEY=": "FROM..TO:COUNT", "FROM..TO:COUNT:log" or "A,B,C". In
/// a search and in a Sobol sequence a range has no count.
using StudyValues =
    std::variant<std::string, std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;

/// The keys that vary ("chain.preload_n") and their values. Of a grid the last key varies fastest.
using StudyKeys = std::vector<std::pair<std::string, StudyValues>>;

/// Options of sweeps and searches.
struct StudyOptions {
    std::vector<std::string> measure = {};  ///< names of taps that are measured beside v_out
    std::vector<std::string> quantities =
        {};  ///< numbers of a run that are kept (docs/measures.md); empty: all
    std::optional<double> band_from_hz = {};    ///< where bands begin [Hz]; unset: half the drive's frequency
    std::optional<std::string> waveforms = {};  ///< name of a tap whose samples are kept, as float32
    std::optional<int> jobs = {};  ///< threads; unset: one for each processor that this process may use
    const std::atomic<bool>* stop =
        nullptr;  ///< true: the study ends within a few steps, and its table is empty
};

/// The points of a sweep.
enum class SweepPoints {
    grid,  ///< every combination of the values
    list,  ///< the first values of all keys, then the second ones; lists of one length
};

/// A column of a study's table.
struct StudyColumn {
    std::string name;  ///< "chain.preload_n", "peak_v_out_m_per_s"
    std::string unit;  ///< "": none
    /// From the first point to the last; NaN: the run does not determine the number.
    std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values;
};

/// The table of a study, a row for each point, in their order.
struct StudyTable {
    std::vector<StudyColumn>
        columns;  ///< point, the keys that vary, status, the numbers, integrator, scene_hash, message
    std::vector<float>
        waveforms;  ///< row-major [point][sample][channel]; empty without StudyOptions::waveforms
    std::size_t waveform_samples = 0;   ///< of each point; NaN after a point's last one
    std::size_t waveform_channels = 1;  ///< as many as the tap has at any point, NaN where it has fewer
    nlohmann::ordered_json provenance;

    /// The numbers or integers of a column. @throws std::out_of_range when no such column has that name
    std::vector<double> operator[](std::string_view name) const;
    /// The words of a column, as "status". @throws std::out_of_range when no column of words has that name
    const std::vector<std::string>& words(std::string_view name) const;
};

/// Runs every point. A point that cannot be simulated is a row with its reason.
/// @param sobol points of a Sobol sequence in the ranges, in place of a grid
/// @throws std::invalid_argument with every fault of keys, values and options, a line each; OutOfMemory. Faults of the other keys of the
/// scene are in the rows.
StudyTable sweep(const Scene& scene, const StudyKeys& vary, const StudyOptions& options = {},
                 SweepPoints points = SweepPoints::grid, std::optional<std::int64_t> sobol = {});

/// The goal of a search.
struct SearchGoal {
    std::string maximise = {};  ///< a number of a run; this or minimise
    std::string minimise = {};
    std::vector<std::string> subject_to = {};  ///< "MEASURE >= NUMBER" or "MEASURE <= NUMBER"
    std::int64_t evaluations = 2000;           ///< the most points that are run
    std::uint64_t seed = 1;
};

/// The outcome of a search.
struct SearchOutcome {
    StudyTable evaluations;  ///< in their order
    nlohmann::ordered_json
        summary;  ///< the best point and its neighbourhood, as `hertzline optimise --json` prints it
    std::vector<std::string> warnings;
};

/// Searches for the best point. @throws as sweep()
SearchOutcome optimise(const Scene& scene, const StudyKeys& vary, const SearchGoal& goal,
                       const StudyOptions& options = {});

}  // namespace hertzline
