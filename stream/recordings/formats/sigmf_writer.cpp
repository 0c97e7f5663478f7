#include <chrono>
#include <stdexcept>

#include <fmt/format.h>

#include "core/scene/text.hpp"
#include "stream/files/errors.hpp"
#include "stream/files/growing_file.hpp"
#include "stream/files/output_file.hpp"
#include "stream/float32.hpp"
#include "stream/provenance.hpp"
#include "stream/recordings/checked_writer.hpp"
#include "stream/recordings/formats/sigmf.hpp"

namespace hertzline::stream {

namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using std::chrono::steady_clock;

constexpr double flush_every_s = 0.5;         // of samples or by the clock, what comes first
constexpr std::size_t max_captures = 10'000;  // each costs a hundred bytes, written anew with the next one

/// What the specification allows.
constexpr std::size_t max_channels = 1000;
constexpr double lowest_rate_hz = 1;
constexpr double highest_rate_hz = 1e12;

void require_possible(const fs::path& path, const RecordingHead& head) {
    if (head.columns.size() > max_channels) {
        cannot_write(path, fmt::format("found {} columns, allowed: at most {} in SigMF", head.columns.size(),
                                       max_channels));
    }
    if (!(head.sample_rate_hz >= lowest_rate_hz && head.sample_rate_hz <= highest_rate_hz)) {
        cannot_write(path, fmt::format("found {} samples per second, allowed: {} to {} in SigMF",
                                       number_text(head.sample_rate_hz), number_text(lowest_rate_hz),
                                       number_text(highest_rate_hz)));
    }
}

Json global_of(const RecordingHead& head) {
    std::string names;
    Json columns = Json::array();
    for (const Column& column : head.columns) {
        names += (names.empty() ? "" : ", ") + column.name;
        columns.push_back({{"name", column.name}, {"quantity", column.quantity}, {"unit", column.unit}});
    }
    Json global{{"core:datatype", "rf32_le"},
                {"core:version", "1.2.0"},
                {"core:num_channels", head.columns.size()},
                {"core:sample_rate", head.sample_rate_hz},
                {"core:description", "A granular-chain ultrasound source: " + names},
                {"core:hw", "none, simulated"},
                {"core:recorder", fmt::format("hertzline {}", program_version())},
                {"core:extensions", {{{"name", "hertzline"}, {"version", "1.0.0"}, {"optional", true}}}}};
    for (const auto& [key, value] : head.provenance.items()) {
        global["hertzline:" + key] = value;
    }
    global["hertzline:columns"] = columns;
    return global;
}

class SigmfWriter final : public CheckedWriter {
public:
    SigmfWriter(const fs::path& either, const RecordingHead& head, Appearance appearance)
        : CheckedWriter(either, {head.columns, head.sample_rate_hz, NumberType::float32, head.provenance}),
          appearance_(appearance),
          meta_path_(sigmf_paths(either).meta),
          data_(sigmf_paths(either).data, head.columns.size() * sizeof(float)),
          meta_{{"global", global_of(head)}, {"captures", Json::array()}, {"annotations", Json::array()}},
          half_a_second_(static_cast<std::int64_t>(flush_every_s * head.sample_rate_hz)) {
        require_possible(either, head);
        const OutputFile writable(meta_path_, StagedFile::Devices::refused);  // fails now or not at all
    }

private:
    void begin_capture(Capture capture) override {
        Json& captures = meta_["captures"];
        if (captures.size() == max_captures) {
            cannot_write(path(), fmt::format("found more than {} gaps", max_captures - 1));
        }
        captures.push_back({{"core:sample_start", capture.row},
                            {"core:global_index", capture.sample},
                            {"core:datetime", utc_text(std::chrono::system_clock::now())}});
        meta_is_stale_ = true;
    }

    void append(std::int64_t, std::span<const double> values) override {
        floats_.assign(values.begin(), values.end());
        const std::span<const std::byte> bytes = wire_bytes(floats_);
        if (!appeared_ && appearance_ == Appearance::early) {
            appear();
        }
        if (!data_.fits(bytes.size())) {
            flush();
        }
        data_.write(bytes);
        const auto now_held = rows() + static_cast<std::int64_t>(values.size() / head().columns.size());
        const std::chrono::duration<double> waited = steady_clock::now() - last_flush_;
        if (now_held - flushed_ >= half_a_second_ || waited.count() >= flush_every_s) {
            flush();
            flushed_ = now_held;
        }
    }

    void finish() override {
        if (!appeared_) {
            appear();
        }
        flush();
        data_.commit();
    }

    KeptRows rescue() override {
        try {
            flush();
        } catch (const std::exception&) {  // what was flushed before is there, and so are its captures
        }
        const std::int64_t rows = data_.records();
        if (rows == 0 && !appeared_) {
            remove();
            return {};
        }
        const fs::path file = data_.keep();
        if (appeared_) {
            return {rows, rows > 0 ? path() : fs::path()};
        }
        OutputFile meta(meta_path_, StagedFile::Devices::refused);
        meta.write(meta_text());
        meta.flush();
        meta.keep();
        return {rows, file};
    }

    void remove() noexcept override {
        data_.abandon();
        if (appeared_) {
            std::error_code gone;
            fs::remove(meta_path_, gone);
        }
    }

    /// Takes the place of what had the name. Old meta go first and new ones come last: they never lie beside
    /// data that are not theirs.
    void appear() {
        fs::remove(meta_path_);
        data_.appear();
        appeared_ = true;
        save_meta();
    }

    /// A capture is known before its samples are there: the other way round they would pass for its predecessor's.
    void flush() {
        data_.require_present();  // else the metadata of that name are another recording's
        if (meta_is_stale_ && appeared_) {
            save_meta();
        }
        data_.flush();
        last_flush_ = steady_clock::now();
    }

    std::string meta_text() const { return meta_.dump(2, ' ', false, Json::error_handler_t::replace) + '\n'; }

    void save_meta() {
        OutputFile file(meta_path_, StagedFile::Devices::refused);
        file.write(meta_text());
        file.commit();
        meta_is_stale_ = false;
    }

    Appearance appearance_;
    fs::path meta_path_;
    GrowingFile data_;
    Json meta_;
    std::int64_t half_a_second_;  // in samples
    std::int64_t flushed_ = 0;    // samples
    steady_clock::time_point last_flush_ = steady_clock::now();
    std::vector<float> floats_;
    bool meta_is_stale_ = false;
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
    return std::make_unique<SigmfWriter>(either, head, appearance);
}

}  // namespace hertzline::stream
