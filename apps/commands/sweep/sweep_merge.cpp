#include "apps/commands/sweep/sweep_merge.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "recordings/recording_formats.hpp"
#include "studies/sweep/journal.hpp"
#include "studies/sweep/sweep_table.hpp"
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.hpp"
#include "apps/commands/sweep/sweep_result.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

using studies::Journal;
using studies::PointCounts;
using studies::Sweep;

/// @throws WrongUse when two names are those of one file
void refuse_repeated(const std::vector<std::string>& names) {
    std::set<std::filesystem::path> seen;
    for (const std::string& name : names) {
        if (!seen.insert(recordings::recording_name(name)).second) {
            throw WrongUse(
                fmt::format("--merge: found {} a second time, allowed: each journal once", printable(name)));
        }
    }
}

/// The journals of all parts, in their order.
std::vector<Journal> open_parts(const SweepOptions& options, const Sweep& sweep) {
    refuse_repeated(options.parts);
    std::map<std::int64_t, Journal> parts;  // a journal may say that there are millions
    for (const std::string& name : options.parts) {
        Journal journal(name, Journal::Use::read);
        if (const auto difference = studies::journal_difference(journal.text(), sweep, {"shard"})) {
            throw WrongUse(
                fmt::format("{}: found {}, allowed: parts of one sweep", printable(name), *difference));
        }
        const studies::Shard shard = studies::sweep_of_journal(journal.text()).shard;
        const bool again = parts.contains(shard.part);
        if (shard.parts != sweep.shard.parts || again) {
            throw WrongUse(fmt::format("{}: found part {}/{}{}, allowed: each of {} parts once",
                                       printable(name), shard.part, shard.parts, again ? " again" : "",
                                       sweep.shard.parts));
        }
        studies::load_rows(journal, sweep);
        parts.emplace(shard.part, std::move(journal));
    }
    std::vector<Journal> all;
    for (std::int64_t part = 1; part <= sweep.shard.parts; ++part) {
        const auto there = parts.find(part);
        if (there == parts.end()) {
            throw WrongUse(fmt::format("--merge: found no journal of part {}/{}, allowed: all parts", part,
                                       sweep.shard.parts));
        }
        all.push_back(std::move(there->second));
    }
    return all;
}

const Journal& part_of(const std::vector<Journal>& parts, std::int64_t point) {
    return parts[static_cast<std::size_t>(point) % parts.size()];
}

/// @throws WrongUse for options that the journals have, or without a table
void refuse_options_beside_merge(const SweepOptions& options) {
    Faults faults;
    if (!options.scene.scene.empty() || !options.scene.settings.empty() || !options.vary.empty() ||
        !options.points.empty() || options.sobol || options.resume || !options.shard.empty() ||
        !options.quantities.empty() || !options.measures.empty() || !options.waveform.empty()) {
        faults.add("--merge: found options of a sweep, allowed: -o, --json; the journals know the rest");
    } else {
        check_output(options, faults);
    }
    faults.refuse<WrongUse>();
}

/// The sweep of the first journal.
Sweep first_sweep(const std::string& name) {
    const Journal journal(name, Journal::Use::read);
    try {
        return studies::sweep_of_journal(journal.text());
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(fmt::format("cannot read {}: {}", printable(name), error.what()));
    }
}

}  // namespace

Exit merge_parts(const SweepOptions& options) {
    refuse_options_beside_merge(options);
    const Sweep sweep = first_sweep(options.parts.front());
    Faults faults;
    check_tables(options.files, sweep.demand.waveform, faults);
    faults.refuse<WrongUse>();
    const std::vector<Journal> parts = open_parts(options, sweep);
    for (std::int64_t point = 0; point < sweep.plan.size(); ++point) {
        if (const Journal& part = part_of(parts, point); !part.has(point)) {
            throw std::runtime_error(fmt::format("{} lacks {}: run that part to its end with --resume",
                                                 part.path().string(), sweep.plan.name(point)));
        }
    }
    stop_asked();
    if (!write_result(options, sweep, studies::table_of(sweep, parts))) {
        spdlog::error("stopped before the end; nothing was saved");
        return Exit::failed;
    }
    PointCounts counts;
    for (std::int64_t point = 0; point < sweep.plan.size(); ++point) {
        ++counts[part_of(parts, point).status(point)];
    }
    print_counts(options, counts, options.files);
    return Exit::done;
}

}  // namespace hertzline::app
