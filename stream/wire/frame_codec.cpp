#include "stream/wire/frame_codec.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/compile.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hertzline::stream {

namespace {

using Json = nlohmann::json;

constexpr std::uint64_t max_count = std::numeric_limits<std::int64_t>::max();

/// Fit to stand between the quotes of JSON as it is.
bool is_plain_name(std::string_view name) {
    const auto plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
    return !name.empty() && name.size() <= max_name_length && std::all_of(name.begin(), name.end(), plain);
}

/// Returns whether the caller of encode_header() keeps its contract; checked by assertions only.
[[maybe_unused]] bool is_encodable(const FrameHeader& header) {
    return is_plain_name(header.stream) && is_plain_name(header.unit) && is_plain_name(header.run) &&
           std::isfinite(header.fs) && header.fs > 0 && std::isfinite(header.t()) && header.n >= 1 &&
           header.channels >= 1 && header.burst_sample <= header.sample &&
           std::max({header.seq, header.sample, header.burst, header.epoch, header.dropped}) <= max_count;
}

/// Reads members of one JSON object; remembers the first thing that is wrong.
class HeaderReader {
public:
    explicit HeaderReader(const Json& object) : object_(object) {}

    std::string name(const char* key) {
        const Json* value = find(key);
        const auto* text = value != nullptr ? value->get_ptr<const std::string*>() : nullptr;
        if (text == nullptr || !is_plain_name(*text)) {
            return fail(key, "a plain text of 1 to 64 characters"), std::string();
        }
        return *text;
    }

    double number(const char* key) {
        const Json* value = find(key);
        if (value == nullptr || !value->is_number() || !std::isfinite(value->get<double>())) {
            return fail(key, "a number"), 0.0;
        }
        return value->get<double>();
    }

    std::uint64_t count(const char* key) { return count_of(find(key), key); }

    /// The two extents of "shape", both at least 1.
    std::pair<std::size_t, std::size_t> shape() {
        const Json* value = find("shape");
        if (value == nullptr || !value->is_array() || value->size() != 2) {
            return fail("shape", "[samples, channels]"), std::pair<std::size_t, std::size_t>();
        }
        const std::uint64_t rows = count_of(&(*value)[0], "shape");
        const std::uint64_t columns = count_of(&(*value)[1], "shape");
        if (rows == 0 || columns == 0) {
            fail("shape", "[samples, channels], each at least 1");
        }
        return {rows, columns};
    }

    void fail(const char* key, const char* allowed) {
        if (fault_.empty()) {
            fault_ = fmt::format("frame header: \"{}\" is missing or not {}", key, allowed);
        }
    }
    const std::string& fault() const { return fault_; }

private:
    const Json* find(const char* key) const {
        const auto found = object_.find(key);
        return found != object_.end() ? &*found : nullptr;
    }

    std::uint64_t count_of(const Json* value, const char* key) {
        const auto* number = value != nullptr ? value->get_ptr<const Json::number_unsigned_t*>() : nullptr;
        if (number == nullptr || *number > max_count) {
            return fail(key, "a whole number from 0 to 2^63 - 1"), std::uint64_t{0};
        }
        return *number;
    }

    const Json& object_;
    std::string fault_;
};

/// n * channels * 4 == payload_bytes, by division: the product of two numbers from outside may overflow.
bool fills(std::size_t n, std::size_t channels, std::size_t payload_bytes) {
    const std::size_t numbers = payload_bytes / sizeof(float);
    return payload_bytes % sizeof(float) == 0 && numbers % channels == 0 && numbers / channels == n;
}

}  // namespace

void encode_header(const FrameHeader& header, std::string& json) {
    assert(is_encodable(header) && "a frame header that JSON cannot hold");
    json.clear();
    fmt::format_to(
        std::back_inserter(json),
        FMT_COMPILE(R"({{"dtype":"<f4","shape":[{},{}],"unit":"{}","stream":"{}","seq":{},"sample":{},)"
                    R"("burst":{},"burst_sample":{},"epoch":{},"fs":{},"t":{},"dropped":{},"run":"{}"}})"),
        header.n, header.channels, header.unit, header.stream, header.seq, header.sample, header.burst,
        header.burst_sample, header.epoch, header.fs, header.t(), header.dropped, header.run);
    if (header.latency_samples) {
        json.pop_back();
        fmt::format_to(std::back_inserter(json), FMT_COMPILE(R"(,"latency_samples":{}}})"),
                       *header.latency_samples);
    }
}

tl::expected<FrameHeader, std::string> decode_header(std::string_view json, std::size_t payload_bytes) {
    if (json.size() > max_header_bytes) {
        return tl::unexpected{fmt::format("frame header: {} bytes, more than the {} that are read",
                                          json.size(), max_header_bytes)};
    }
    const Json object = Json::parse(json, nullptr, /*allow_exceptions=*/false);
    if (!object.is_object()) {
        return tl::unexpected{std::string("frame header: not a JSON object")};
    }
    HeaderReader reader(object);
    FrameHeader header;
    if (reader.name("dtype") != "<f4") {
        reader.fail("dtype", "\"<f4\"");
    }
    std::tie(header.n, header.channels) = reader.shape();
    header.unit = reader.name("unit");
    header.stream = reader.name("stream");
    header.seq = reader.count("seq");
    header.sample = reader.count("sample");
    header.burst = reader.count("burst");
    header.burst_sample = reader.count("burst_sample");
    if (header.burst_sample > header.sample) {
        reader.fail("burst_sample", "a whole number up to \"sample\"");
    }
    header.epoch = reader.count("epoch");
    header.fs = reader.number("fs");
    if (header.fs <= 0) {
        reader.fail("fs", "a positive number");
    }
    const double t = reader.number("t");
    header.dropped = reader.count("dropped");
    header.run = reader.name("run");
    if (object.contains("latency_samples")) {
        header.latency_samples = static_cast<std::int64_t>(reader.count("latency_samples"));
    }
    if (!reader.fault().empty()) {
        return tl::unexpected{reader.fault()};
    }
    if (!std::isfinite(header.t()) || !(std::abs(t - header.t()) <= 1e-9 * header.t())) {
        return tl::unexpected{fmt::format("frame header: t = {} is not sample / fs = {}", t, header.t())};
    }
    if (!fills(header.n, header.channels, payload_bytes)) {
        return tl::unexpected{fmt::format("frame header: shape [{}, {}] of float32 does not fill {} bytes",
                                          header.n, header.channels, payload_bytes)};
    }
    return header;
}

}  // namespace hertzline::stream
