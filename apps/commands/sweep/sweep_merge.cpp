#include "apps/commands/sweep/sweep_merge.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/commands/sweep/sweep_result.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "stream/recordings/recording_formats.hpp"
#include "stream/sweep/journal.hpp"
#include "stream/sweep/sweep_files.hpp"

namespace hertzline::app {

namespace {

using stream::Journal;
using stream::PointCounts;
using stream::Sweep;

/// @throws WrongUse when two names are those of one file
void refuse_repeated(const std::vector<std::string>& names) {
    std::set<std::filesystem::path> seen;
    for (const std::string& name : names) {
        if (!seen.insert(stream::recording_name(name)).second) {
            throw WrongUse(
                fmt::format("--merge: found {} a second time, allowed: each journal once", printable(name)));
        }
    }
}

/// The journals of all parts, in their order.
std::vector<Journal> open_parts(const SweepOptions& options, const Sweep& sweep) {
    refuse_repeated(options.parts);
    std::vector<std::optional<Journal>> parts(static_cast<std::size_t>(sweep.shard.parts));
    const std::string text = stream::journal_text(sweep);
    for (const std::string& name : options.parts) {
        Journal journal(name, Journal::Use::read);
        if (const auto difference = stream::journal_difference(journal.text(), text, true)) {
            throw WrongUse(
                fmt::format("{}: found {}, allowed: parts of one sweep", printable(name), *difference));
        }
        const stream::Shard shard = stream::sweep_of_journal(journal.text()).shard;
        auto& part = parts.at(static_cast<std::size_t>(shard.part - 1));
        if (shard.parts != sweep.shard.parts || part) {
            throw WrongUse(fmt::format("{}: found part {}/{}{}, allowed: each of {} parts once",
                                       printable(name), shard.part, shard.parts, part ? " again" : "",
                                       sweep.shard.parts));
        }
        require_rows_of(sweep, journal);
        journal.load(sweep.plan.size());
        part.emplace(std::move(journal));
    }
    std::vector<Journal> all;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i]) {
            throw WrongUse(fmt::format("--merge: found no journal of part {}/{}, allowed: all parts", i + 1,
                                       parts.size()));
        }
        all.push_back(*std::move(parts[i]));
    }
    return all;
}

void refuse_options_beside_merge(const SweepOptions& options) {
    if (!options.scene.scene.empty() || !options.scene.settings.empty() || !options.vary.empty() ||
        !options.points.empty() || options.sobol || options.resume || !options.shard.empty() ||
        !options.quantities.empty() || !options.measures.empty() || !options.waveform.empty()) {
        throw WrongUse("--merge: found options of a sweep, allowed: -o, --json; the journals know the rest");
    }
    refuse_no_output(options);
}

/// The sweep of the first journal.
Sweep first_sweep(const std::string& name) {
    const Journal journal(name, Journal::Use::read);
    try {
        return stream::sweep_of_journal(journal.text());
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("cannot read {}: {}", printable(name), error.what()));
    }
}

}  // namespace

Exit merge_parts(const SweepOptions& options) {
    refuse_options_beside_merge(options);
    const Sweep sweep = first_sweep(options.parts.front());
    if (!options.output.empty()) {
        if (const auto fault = stream::sweep_file_fault(options.output, sweep.demand.waveform.has_value())) {
            throw WrongUse(*fault);
        }
    }
    const std::vector<Journal> parts = open_parts(options, sweep);
    std::vector<const Journal*> journals;
    std::ranges::transform(parts, std::back_inserter(journals), [](const Journal& part) { return &part; });
    const stream::SweepTable table(sweep, journals);
    if (const std::int64_t point = table.first_missing(); point >= 0) {
        const Journal& part = parts[static_cast<std::size_t>(point % sweep.shard.parts)];
        throw std::runtime_error(fmt::format("{} lacks {}: run that part to its end with --resume",
                                             part.path().string(), sweep.plan.name(point)));
    }
    stop_asked();
    if (!write_result(options, table)) {
        spdlog::error("stopped before the end; nothing was saved");
        return Exit::failed;
    }
    PointCounts counts;
    for (std::int64_t point = 0; point < sweep.plan.size(); ++point) {
        ++counts[parts[static_cast<std::size_t>(point % sweep.shard.parts)].status(point)];
    }
    print_counts(options, counts, options.output);
    return Exit::done;
}

}  // namespace hertzline::app
