#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/model/bursts.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "recordings/checked_writer.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/formats/sigmf/sigmf_files.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

using std::chrono::steady_clock;

/// Annotations are written anew with each further one, and viewers draw them all.
constexpr std::size_t max_burst_annotations = 1000;

enum class LastBurst { left_out, included };

/// The bursts of a run whose scene may change.
struct EpochBursts {
    double sample_rate_hz;
    std::span<const Epoch> epochs;  ///< in their order, at least one

    const Epoch& epoch_of(std::int64_t sample) const noexcept {
        const Epoch* found = &epochs.front();
        for (const Epoch& epoch : epochs) {
            found = epoch.first_sample <= sample ? &epoch : found;
        }
        return *found;
    }
};

/// An annotation and its first row.
struct Annotation {
    std::int64_t row;
    Json json;
};

Json annotation(std::int64_t burst, std::int64_t start, std::int64_t count) {
    return {{"core:sample_start", start},
            {"core:sample_count", count},
            {"core:generator", "hertzline"},
            {"core:label", "burst " + std::to_string(burst)},
            {"hertzline:burst", burst}};
}

/// Rows without a gap.
struct Stretch {
    std::int64_t row;
    std::int64_t sample;  ///< of the first row
    std::int64_t rows;
};

/// @param last the treatment of a burst that continues beyond the stretch
void annotate(const EpochBursts& all, const Stretch& stretch, LastBurst last,
              std::vector<Annotation>& annotations) {
    const Epoch& epoch = all.epoch_of(stretch.sample);
    const Bursts bursts(all.sample_rate_hz, epoch.repetition_hz);
    const std::int64_t begin = stretch.sample - epoch.first_sample;
    const std::int64_t end = begin + stretch.rows;
    BurstPlace place = bursts.at(begin);
    for (std::int64_t from = begin; from < end && annotations.size() < max_burst_annotations;) {
        const bool goes_on = !bursts.repeat() || bursts.first_sample(place.burst + 1) > end;
        const std::int64_t to = goes_on ? end : bursts.first_sample(place.burst + 1);
        if (!goes_on || last == LastBurst::included) {
            const std::int64_t row = stretch.row + from - begin;
            annotations.push_back({row, annotation(epoch.first_burst + place.burst, row, to - from)});
        }
        from = to;
        place = bursts.at(to);
    }
}

/// Returns an annotation for each burst with samples among the first `rows`, at most max_burst_annotations. When samples are
/// missing a burst has one in each capture. @param captures each lies in one epoch
/// @param last the burst in which the rows end; while they grow it is not complete
std::vector<Annotation> burst_annotations(const EpochBursts& bursts, std::span<const Capture> captures,
                                          std::int64_t rows, LastBurst last) {
    std::vector<Annotation> annotations;
    for (std::size_t i = 0; i < captures.size() && annotations.size() < max_burst_annotations; ++i) {
        const std::int64_t row = captures[i].row;
        const bool is_last = i + 1 == captures.size();
        const std::int64_t next = is_last ? rows : std::min(rows, captures[i + 1].row);
        const bool grows = is_last || next == rows;
        if (next > row) {
            annotate(bursts, {row, captures[i].sample, next - row}, grows ? last : LastBurst::included,
                     annotations);
        }
    }
    return annotations;
}

constexpr double flush_every_s = 0.5;         // of samples or by the clock, the earlier
constexpr std::size_t max_captures = 10'000;  // each costs a hundred bytes, written anew with the next one
constexpr std::size_t max_captures_of_changes = 2'000;  // later changes have annotations alone
constexpr double meta_bytes_per_s = 8e6;  // the larger the metadata, the more seldom they are written

/// The specification's maximum.
constexpr double lowest_rate_hz = 1;
constexpr double highest_rate_hz = 1e12;

constexpr std::size_t max_recordings = 100;  // in a collection: each has a descriptor and a buffer of 1 MiB

class SigmfWriter final : public CheckedWriter {
public:
    /// A single recording, or a collection with one for each column.
    enum class Kind { recording, collection };

    SigmfWriter(const fs::path& path, const RecordingHead& head, Appearance appearance, Kind kind)
        : CheckedWriter(path, {head.columns, head.sample_rate_hz, NumberType::float32, head.provenance}),
          appearance_(appearance),
          half_a_second_(static_cast<std::int64_t>(flush_every_s * head.sample_rate_hz)) {
        epochs_ = measures::epochs_of(head.provenance, head.sample_rate_hz);
        if (const auto changes = head.provenance.find("changes"); changes != head.provenance.end()) {
            progress_.may_change = true;
            for (const Json& change : *changes) {
                progress_.changes.add(change);
            }
        }
        if (kind == Kind::collection) {
            require_possible(max_recordings, "a SigMF collection, which has files for each");
            begin_collection();
        } else {
            require_possible(sigmf_max_channels, "SigMF");
            std::vector<std::size_t> all(head.columns.size());
            std::iota(all.begin(), all.end(), std::size_t{0});
            recordings_.emplace_back(sigmf_paths(path), head, std::move(all));
        }
    }

private:
    void require_possible(std::size_t max_columns, const char* format) const {
        if (head().columns.size() > max_columns) {
            cannot_write(path(), fmt::format("found {} columns, allowed: at most {} in {}",
                                             head().columns.size(), max_columns, format));
        }
        if (!(head().sample_rate_hz >= lowest_rate_hz && head().sample_rate_hz <= highest_rate_hz)) {
            cannot_write(path(), fmt::format("found {} samples per second, allowed: {} to {} in SigMF",
                                             number_text(head().sample_rate_hz), number_text(lowest_rate_hz),
                                             number_text(highest_rate_hz)));
        }
    }

    void begin_collection() {
        const OutputFile writable(path(), StagedFile::Devices::refused);  // fails now or not at all
        const std::string name = path().stem().string();
        if (!names_a_neighbour(name)) {
            cannot_write(path(),
                         "its name is not UTF-8 without control characters, as the names in a SigMF "
                         "collection have to be");
        }
        collection_ = path();
        for (std::size_t i = 0; i < head().columns.size(); ++i) {
            const std::string base = name + '-' + head().columns[i].name;
            const auto place = [&](std::string_view ending) {
                return path().parent_path() / (base + std::string(ending));
            };
            recordings_.emplace_back(SigmfPaths{place(sigmf_meta_ending), place(sigmf_data_ending)}, head(),
                                     std::vector<std::size_t>{i});
            recordings_.back().name_collection(name);
        }
    }

    void begin_capture(Capture capture) override {
        if (captures_.size() == max_captures) {
            cannot_write(path(), fmt::format("found more than {} gaps", max_captures - 1));
        }
        if (!captures_.empty() && captures_.back().row == capture.row) {
            captures_.pop_back();  // an epoch whose first samples are missing
            progress_.captures.drop_last();
        }
        captures_.push_back(capture);
        progress_.captures.add({{"core:sample_start", capture.row},
                                {"core:global_index", capture.sample},
                                {"core:datetime", measures::utc_text(std::chrono::system_clock::now())}});
        gap_is_unknown_ = true;
    }

    /// A capture and an annotation of its own.
    void changed(const Json& change) override {
        const auto sample = change.value("sample", std::int64_t{0});
        if (!epochs_.empty()) {
            measures::add_epoch(epochs_, change, head().sample_rate_hz);
        }
        if (rows() > 0 && sample == due() && captures_.size() < max_captures_of_changes) {
            const bool is_unknown = std::exchange(gap_is_unknown_, false);
            begin_capture({rows(), sample});
            gap_is_unknown_ = is_unknown;  // no sample is missing here
        }
        progress_.may_change = true;
        progress_.changes.add(change);
        changes_.push_back({rows(),
                            {{"core:sample_start", rows()},
                             {"core:sample_count", 0},
                             {"core:generator", "hertzline"},
                             {"core:label", fmt::format("epoch {}", change.value("epoch", std::int64_t{0}))},
                             {"hertzline:change", change}}});
        if (bursts_.size() == max_burst_annotations) {
            progress_.annotations.add(changes_.back().json);  // all further ones are such
        } else {
            note_annotations();
        }
        meta_is_stale_ = true;
    }

    void append(std::int64_t, std::span<const double> values) override {
        if (!appeared_ && appearance_ == Appearance::early) {
            appear(due());
        }
        for (SigmfFiles& recording : recordings_) {
            recording.write(values, [this] { flush(); });
        }
        const auto now_held = rows() + static_cast<std::int64_t>(values.size() / head().columns.size());
        const std::chrono::duration<double> waited = steady_clock::now() - last_flush_;
        if (now_held - flushed_ >= half_a_second_ || waited.count() >= flush_every_s) {
            flush();
            flushed_ = now_held;
        }
    }

    void finish() override {
        if (appeared_) {
            flush();
            annotate(LastBurst::included, rows());
            save_meta(due());
            for (SigmfFiles& recording : recordings_) {
                recording.commit();
            }
            return;
        }
        for (SigmfFiles& recording : recordings_) {
            recording.close();  // an older recording goes only when the new files are complete
        }
        annotate(LastBurst::included, rows());
        appear(due());
    }

    KeptRows rescue() override {
        const auto any = [this](bool (SigmfFiles::*is)() const noexcept) {
            return std::any_of(recordings_.begin(), recordings_.end(),
                               [is](const SigmfFiles& recording) { return (recording.*is)(); });
        };
        std::int64_t rows = this->rows();
        if (!any(&SigmfFiles::is_closed)) {
            try {
                flush();
            } catch (const std::exception&) {  // earlier flushed samples and their captures are there
            }
            rows = held_rows();
            if (rows == 0 && !appeared_) {
                remove();
                return {};
            }
        }
        annotate(LastBurst::included, rows);
        std::vector<fs::path> files;
        for (SigmfFiles& recording : recordings_) {
            files.push_back(recording.keep(progress_));
        }
        const bool doubtful = any(&SigmfFiles::is_doubtful);
        rows = doubtful ? 0 : rows;
        if (appeared_) {
            return {rows, rows > 0 || doubtful ? path() : fs::path()};
        }
        return {rows, files.front()};
    }

    void remove() noexcept override {
        for (SigmfFiles& recording : recordings_) {
            recording.remove();
        }
        if (appeared_ && collection_) {
            std::error_code gone;
            fs::remove(*collection_, gone);
        }
    }

    /// A collection lists no recordings that are not its own: the old one goes first and the new one comes last.
    /// @param until the sample before which all changes are known
    void appear(std::int64_t until) {
        progress_.changes_until_sample = until;
        if (collection_) {
            fs::remove(*collection_);
        }
        for (SigmfFiles& recording : recordings_) {
            recording.appear(progress_);
        }
        appeared_ = true;
        meta_is_stale_ = gap_is_unknown_ = false;
        save_collection();
    }

    /// A gap is known before its samples are there: the other way round they would pass for its predecessor's. Changes may follow
    /// later: the metadata name the sample until which they have them.
    void flush() {
        for (SigmfFiles& recording : recordings_) {
            recording.require_present();  // else the metadata of that name are another recording's
        }
        if (appeared_ && (gap_is_unknown_ || (meta_is_stale_ && meta_is_due()))) {
            save_meta(due());
        }
        for (SigmfFiles& recording : recordings_) {
            recording.flush();
        }
        meta_is_stale_ = annotate(LastBurst::left_out, held_rows()) || meta_is_stale_ || progress_.may_change;
        if (meta_is_stale_ && appeared_ && meta_is_due()) {
            save_meta(due());  // after the samples: annotations never precede their samples
        }
        last_flush_ = steady_clock::now();
    }

    bool meta_is_due() const {
        const std::chrono::duration<double> since = steady_clock::now() - saved_meta_;
        const auto bytes = static_cast<double>(progress_.size() * recordings_.size());
        return since.count() >= bytes / meta_bytes_per_s;
    }

    /// @param until the sample before which all changes are known
    void save_meta(std::int64_t until) {
        progress_.changes_until_sample = until;
        for (SigmfFiles& recording : recordings_) {
            recording.save_meta(progress_);
        }
        meta_is_stale_ = gap_is_unknown_ = false;
        saved_meta_ = steady_clock::now();
        save_collection();
    }

    /// Rows of which the system has taken all. Not of files that are closed.
    std::int64_t held_rows() const {
        std::int64_t rows = std::numeric_limits<std::int64_t>::max();
        for (const SigmfFiles& recording : recordings_) {
            rows = std::min(rows, recording.rows());
        }
        return rows;
    }

    /// @param rows that the files have @returns whether there are more annotations than before
    bool annotate(LastBurst last, std::int64_t rows) {
        const std::size_t before = bursts_.size();
        if (epochs_.empty() || (last == LastBurst::left_out && before == max_burst_annotations)) {
            return false;
        }
        bursts_ = burst_annotations({head().sample_rate_hz, epochs_}, captures_, rows, last);
        note_annotations();
        return bursts_.size() > before;
    }

    /// Merges annotations of bursts and changes in the order of their samples, as SigMF demands.
    void note_annotations() {
        std::vector<const Annotation*> all;
        for (const auto* list : {&changes_, &bursts_}) {
            for (const Annotation& one : *list) {
                all.push_back(&one);
            }
        }
        std::ranges::stable_sort(all, {}, &Annotation::row);
        progress_.annotations.clear();
        for (const Annotation* one : all) {
            progress_.annotations.add(one->json);
        }
    }

    void save_collection() const {
        if (!collection_) {
            return;
        }
        Json streams = Json::array();
        for (const SigmfFiles& recording : recordings_) {
            streams.push_back(recording.listed());
        }
        const Json collection{{"core:version", sigmf_version},
                              {"core:description", "A granular-chain ultrasound source, an output each"},
                              {"core:extensions", sigmf_extensions()},
                              {"core:streams", std::move(streams)}};
        OutputFile file(*collection_, StagedFile::Devices::refused);
        file.write(sigmf_text(Json::object({{"collection", collection}})));
        file.commit();
    }

    Appearance appearance_;
    std::optional<fs::path> collection_;
    std::deque<SigmfFiles> recordings_;  // in a collection one for each column
    SigmfProgress progress_;
    std::vector<Capture> captures_;
    std::vector<Epoch> epochs_;  // none: the scene is not known
    std::vector<Annotation> bursts_;
    std::vector<Annotation> changes_;
    std::int64_t half_a_second_;  // in samples
    std::int64_t flushed_ = 0;    // samples
    steady_clock::time_point last_flush_ = steady_clock::now();
    steady_clock::time_point saved_meta_{};
    bool meta_is_stale_ = false;
    bool gap_is_unknown_ = false;  // to the metadata
    bool appeared_ = false;
};

}  // namespace

SigmfPaths sigmf_paths(const fs::path& either) {
    fs::path meta = either;
    fs::path data = either;
    return {meta.replace_extension(sigmf_meta_ending), data.replace_extension(sigmf_data_ending)};
}

std::unique_ptr<RecordingWriter> open_sigmf_writer(const fs::path& either, const RecordingHead& head,
                                                   Appearance appearance) {
    return std::make_unique<SigmfWriter>(either, head, appearance, SigmfWriter::Kind::recording);
}

std::unique_ptr<RecordingWriter> open_sigmf_collection_writer(const fs::path& collection,
                                                              const RecordingHead& head,
                                                              Appearance appearance) {
    return std::make_unique<SigmfWriter>(collection, head, appearance, SigmfWriter::Kind::collection);
}

}  // namespace hertzline::recordings
