#include "stream/recorder.hpp"

#include <algorithm>
#include <cctype>

namespace hertzline {

namespace {

constexpr double bytes_per_number = 24;  // 17 digits, sign, point, exponent, comma

std::int64_t listed(const Chain& chain, RecordedBodies bodies) {
    return bodies == RecordedBodies::all ? static_cast<std::int64_t>(chain.spheres()) : 0;
}

}  // namespace

std::optional<std::string> recording_fault(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::ranges::transform(ending, ending.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::error_code unknown;  // a name that cannot be asked about is no device
    const bool device =
        std::filesystem::is_character_file(path, unknown) || std::filesystem::is_fifo(path, unknown);
    if (ending == ".csv" || (ending.empty() && device)) {
        return std::nullopt;
    }
    return path.string() + ": found the ending \"" + ending + "\", allowed: .csv";
}

double recording_bytes(const Scene& scene, double samples, RecordedBodies bodies) noexcept {
    const double outputs = scene.end.kind == EndKind::plate ? 4 : 2;
    const double all = bodies == RecordedBodies::all ? 2 * static_cast<double>(scene.chain.spheres) : 0;
    return samples * (outputs + all) * bytes_per_number;
}

Recorder::Recorder(const std::filesystem::path& path, const Chain& chain, double sample_rate_hz,
                   RecordedBodies bodies)
    : sample_rate_hz_(sample_rate_hz),
      bodies_(bodies),
      file_(path),
      csv_(file_, csv_columns(chain.end, listed(chain, bodies))) {}

void Recorder::write(const Samples& block) {
    for (std::size_t i = 0; i < block.count; ++i) {
        row_.clear();
        row_.push_back(block.v_last[i]);
        if (!block.v_plate.empty()) {
            row_.push_back(block.v_plate[i]);
            row_.push_back(block.v_out[i]);
        }
        for (std::size_t s = 0; bodies_ == RecordedBodies::all && s < block.spheres; ++s) {
            row_.push_back(block.chain_x[i * block.spheres + s]);
            row_.push_back(block.chain_v[i * block.spheres + s]);
        }
        // counted, not accumulated
        csv_.row(static_cast<double>(block.first + static_cast<std::int64_t>(i)) / sample_rate_hz_, row_);
    }
}

}  // namespace hertzline
