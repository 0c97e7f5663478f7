#include "apps/commands/sweep/sweep_merge.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/command.hpp"
#include "apps/commands/sweep/study_session.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "recordings/recording_formats.hpp"
#include "studies/journal.hpp"
#include "studies/study.hpp"

namespace hertzline::app {

namespace {

using studies::Journal;
using studies::PointCounts;
using studies::Study;

/// Opens the journals of all parts, in their order.
std::vector<Journal> open_parts(const SweepOptions& options, const Study& study) {
    std::map<std::int64_t, Journal> parts;  // a journal can claim millions of parts
    for (std::size_t i = 0; i < options.parts.size(); ++i) {
        const std::string& name = options.parts[i];
        if (const auto fault = recordings::repeated_fault(name, std::span(options.parts).first(i))) {
            throw WrongUse("--merge: " + *fault);
        }
        Journal journal(name, Journal::Use::read);
        if (const auto difference = studies::journal_difference(journal.text(), study, {"shard"})) {
            throw WrongUse(
                fmt::format("{}: found {}, allowed: parts of one sweep", printable(name), *difference));
        }
        const studies::Shard shard = studies::sweep_of_journal(journal.text()).shard;
        const bool again = parts.contains(shard.part);
        if (shard.parts != study.shard.parts || again) {
            throw WrongUse(fmt::format("{}: found part {}/{}{}, allowed: each of {} parts once",
                                       printable(name), shard.part, shard.parts, again ? " again" : "",
                                       study.shard.parts));
        }
        studies::load_rows(journal, study);
        parts.emplace(shard.part, std::move(journal));
    }
    std::vector<Journal> all;
    for (std::int64_t part = 1; part <= study.shard.parts; ++part) {
        const auto there = parts.find(part);
        if (there == parts.end()) {
            throw WrongUse(fmt::format("--merge: the journal of part {}/{} is missing: give all parts", part,
                                       study.shard.parts));
        }
        all.push_back(std::move(there->second));
    }
    return all;
}

const Journal& part_of(const std::vector<Journal>& parts, std::int64_t point) {
    return parts[static_cast<std::size_t>(point) % parts.size()];
}

void refuse_options_beside_merge(const SweepOptions& options) {
    Faults faults;
    if (!options.scene.scene.empty() || !options.scene.settings.empty() || !options.vary.empty() ||
        !options.points.empty() || options.sobol || options.resume || !options.shard.empty() ||
        !options.quantities.empty() || !options.measures.empty() || !options.waveform.empty() ||
        options.band_from_hz || options.jobs) {
        faults.add("--merge: found options of a sweep, allowed: -o, --json; the journals have the others");
    } else {
        check_output(options, faults);
    }
    faults.refuse<WrongUse>();
}

/// Returns the sweep of the first journal.
Study first_sweep(const std::string& name) {
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
    const Study study = first_sweep(options.parts.front());
    Faults faults;
    check_tables(options.files, study.options.waveform, faults);
    faults.refuse<WrongUse>();
    const std::vector<Journal> parts = open_parts(options, study);
    for (std::int64_t point = 0; point < study.plan.size(); ++point) {
        if (const Journal& part = part_of(parts, point); !part.has(point)) {
            throw std::runtime_error(fmt::format("{} lacks {}: run that part to its end with --resume",
                                                 printable_whole(part.path().string()),
                                                 study.plan.name(point)));
        }
    }
    stop_asked();
    if (!write_result(options, study, studies::table_of(study, parts))) {
        spdlog::error("stopped before the end; nothing was saved");
        return Exit::failed;
    }
    PointCounts counts;
    for (std::int64_t point = 0; point < study.plan.size(); ++point) {
        ++counts[part_of(parts, point).status(point)];
    }
    print_counts(options, counts, options.files);
    return Exit::done;
}

}  // namespace hertzline::app
