#include "apps/commands/sweep/shard_argument.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <regex>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "apps/command.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

using Number = std::optional<std::int64_t>;

/// Returns a launcher's number from the environment; nothing where it is absent.
Number number_of_launcher(const char* name) {
    const char* const text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before there are threads
    return text != nullptr ? parsed_number<std::int64_t>(text) : std::nullopt;
}

std::string gaps_fault(std::int64_t task, std::int64_t tasks, std::int64_t first, std::int64_t last) {
    return fmt::format(
        "--shard slurm: found task {} of {} tasks from {} to {}, allowed: an array without gaps that begins "
        "at 1 "
        "(1-8) or at 0; --shard slurm/1-8 runs one task of such an array again",
        task, tasks, first, last);
}

/// The tasks of a whole job array: --array=1-8, which has parts 1/8 to 8/8.
struct JobArray {
    std::int64_t first;
    std::int64_t last;
};

/// Reads "N", tasks 1 to N, or "FIRST-LAST"; nothing where it is none.
std::optional<JobArray> job_array(std::string_view text) {
    const std::size_t dash = text.find('-');
    const Number first =
        dash == std::string_view::npos ? Number(1) : parsed_number<std::int64_t>(text.substr(0, dash));
    const Number last =
        parsed_number<std::int64_t>(text.substr(dash == std::string_view::npos ? 0 : dash + 1));
    const bool fits = first && last && *first >= 0 && *first <= *last && *last - *first < studies::max_points;
    return fits ? std::optional(JobArray{*first, *last}) : std::nullopt;
}

/// Returns the part of a task of a job array. A task that is submitted again needs the array that it was in.
tl::expected<studies::Shard, std::string> shard_of_slurm_task(std::optional<JobArray> whole_array) {
    const Number task = number_of_launcher("SLURM_ARRAY_TASK_ID");
    const Number tasks = number_of_launcher("SLURM_ARRAY_TASK_COUNT");
    const Number first = number_of_launcher("SLURM_ARRAY_TASK_MIN");
    const Number last = number_of_launcher("SLURM_ARRAY_TASK_MAX");
    if (!task || !tasks || !first || !last) {
        return tl::unexpected<std::string>(
            "--shard slurm: SLURM_ARRAY_TASK_ID, _COUNT, _MIN or _MAX is missing: start it in a job of "
            "sbatch --array=1-N");
    }
    if (whole_array) {
        const auto [whole_first, whole_last] = *whole_array;
        if (*first < whole_first || *task < whole_first || *task > whole_last) {
            return tl::unexpected(fmt::format(
                "--shard slurm/{0}-{1}: found task {2} of an array from {3} to {4}, allowed: tasks from {0} "
                "to {1}",
                whole_first, whole_last, *task, *first, *last));
        }
        return studies::Shard{*task - whole_first + 1, whole_last - whole_first + 1};
    }
    const bool whole = (*first == 0 || *first == 1) && *last - *first + 1 == *tasks;
    if (!whole || *task < *first || *task > *last || *tasks > studies::max_points) {
        return tl::unexpected(gaps_fault(*task, *tasks, *first, *last));
    }
    return studies::Shard{*task - *first + 1, *tasks};
}

/// The environment variables of a launcher of ranks.
struct RankNames {
    const char* rank;  ///< from 0
    const char* ranks;
};
/// A launcher inside of a Slurm job comes before Slurm. The last variables are srun's: sbatch sets SLURM_NTASKS without starting tasks.
constexpr std::array launchers{RankNames{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                               RankNames{"PMI_RANK", "PMI_SIZE"},
                               RankNames{"SLURM_PROCID", "SLURM_STEP_NUM_TASKS"}};

tl::expected<studies::Shard, std::string> shard_of_rank() {
    for (const RankNames& names : launchers) {
        const Number rank = number_of_launcher(names.rank);
        const Number ranks = number_of_launcher(names.ranks);
        if (rank && ranks && *rank >= 0 && *rank < *ranks && *ranks <= studies::max_points) {
            return studies::Shard{*rank + 1, *ranks};
        }
    }
    std::string allowed;
    for (const RankNames& names : launchers) {
        allowed += fmt::format("{}{} with {}", allowed.empty() ? "" : ", ", names.rank, names.ranks);
    }
    return tl::unexpected(
        "--shard mpi: the environment has no rank: start it with mpirun or srun, which set " + allowed);
}

/// Returns whether a launcher names the part, without knowledge of earlier parts.
bool is_of_launcher(const std::string& text) {
    return text == "slurm" || text == "mpi";
}

}  // namespace

tl::expected<studies::Shard, std::string> shard_argument(const std::string& text) {
    if (text.empty()) {
        return studies::Shard();
    }
    if (text == "mpi") {
        return shard_of_rank();
    }
    if (text == "slurm") {
        return shard_of_slurm_task(std::nullopt);
    }
    const std::size_t slash = std::min(text.find('/'), text.size());
    const std::string_view before = std::string_view(text).substr(0, slash);
    const Number part = parsed_number<std::int64_t>(before);
    const std::string_view after = std::string_view(text).substr(std::min(slash + 1, text.size()));
    if (const auto array = before == "slurm" ? job_array(after) : std::nullopt) {
        return shard_of_slurm_task(array);
    }
    const Number parts = parsed_number<std::int64_t>(after);
    if (part && parts && *part >= 1 && *part <= *parts && *parts <= studies::max_points) {
        return studies::Shard{*part, *parts};
    }
    return tl::unexpected(
        fmt::format("--shard: found {}, allowed: I/N (1/4 is the first of 4 parts), slurm, "
                    "slurm/N, slurm/FIRST-LAST or mpi",
                    quoted_briefly(text)));
}

std::string journal_name(const std::string& file, const studies::Shard& shard) {
    return file + (shard.parts > 1 ? fmt::format(".{}-of-{}", shard.part, shard.parts) : std::string()) +
           ".journal";
}

void refuse_other_parts(const std::string& text, const std::string& file, const studies::Shard& shard) {
    if (!is_of_launcher(text)) {
        return;
    }
    const fs::path path(file);
    const std::string before = path.filename().string() + '.';
    const std::regex form(R"((\d+)-of-(\d+)\.journal)");
    std::error_code unreadable;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(path.has_parent_path() ? path.parent_path() : fs::path("."), unreadable)) {
        const std::string name = entry.path().filename().string();
        std::smatch numbers;
        const std::string rest = name.starts_with(before) ? name.substr(before.size()) : std::string();
        if (std::regex_match(rest, numbers, form) &&
            parsed_number<std::int64_t>(numbers[2].str()) != shard.parts) {
            throw WrongUse(fmt::format(
                "--shard {0}: found part {1} of {2}, and beside it {3}, allowed: journals with the "
                "same number of parts; --shard {4}{5} runs one of those parts again",
                text, shard.part, shard.parts, printable(entry.path().string()),
                text == "slurm" ? "slurm/" : "I/", numbers[2].str()));
        }
    }
}

}  // namespace hertzline::app
