#include "recordings/formats/sigmf/sigmf_files.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sodium.h>

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/float32.hpp"

namespace hertzline::recordings {

namespace {

namespace fs = std::filesystem;

std::string digits_of(const std::array<unsigned char, crypto_hash_sha512_BYTES>& hash) {
    std::array<char, 2 * crypto_hash_sha512_BYTES + 1> digits{};
    return sodium_bin2hex(digits.data(), digits.size(), hash.data(), hash.size());
}

/// Returns the SHA-512 of the text in hexadecimal digits, by which a collection names the state of its files.
std::string sha512(const std::string& text) {
    std::array<unsigned char, crypto_hash_sha512_BYTES> hash{};
    crypto_hash_sha512(hash.data(), reinterpret_cast<const unsigned char*>(text.data()), text.size());
    return digits_of(hash);
}

Json global_of(const RecordingHead& head, const std::vector<std::size_t>& chosen) {
    std::string names;
    Json columns = Json::array();
    for (const std::size_t i : chosen) {
        const Column& column = head.columns[i];
        names += (names.empty() ? "" : ", ") + column.name;
        columns.push_back({{"name", column.name}, {"quantity", column.quantity}, {"unit", column.unit}});
    }
    Json global{{"core:datatype", "rf32_le"},
                {"core:version", sigmf_version},
                {"core:num_channels", chosen.size()},
                {"core:sample_rate", head.sample_rate_hz},
                {"core:description", "A granular-chain ultrasound source: " + names},
                {"core:hw", "none, simulated"},
                {"core:recorder", fmt::format("hertzline {}", measures::program_version())},
                {"core:extensions", sigmf_extensions()}};
    for (const auto& [key, value] : head.provenance.items()) {
        if (key != "changes") {
            global["hertzline:" + key] = value;
        }
    }
    global["hertzline:columns"] = columns;
    return global;
}

}  // namespace

void SigmfList::add(const Json& entry) {
    const std::string line = "\n  " + indent_;
    before_last_ = text_.size();
    text_ += (text_.empty() ? "" : ",") + line;
    for (const char letter : entry.dump(2, ' ', false, Json::error_handler_t::replace)) {
        letter == '\n' ? text_ += line : text_ += letter;
    }
}

std::string SigmfList::text() const {
    return text_.empty() ? "[]" : '[' + text_ + '\n' + indent_ + ']';
}

Json sigmf_extensions() {
    return Json::array({Json{{"name", "hertzline"}, {"version", "1.0.0"}, {"optional", true}}});
}

bool names_a_neighbour(const std::string& text) {
    constexpr std::size_t longest = 255;  // bytes, in the file systems of Linux
    return !text.empty() && text.size() <= longest && text != "." && text != ".." &&
           text.find('/') == std::string::npos && is_plain(text);
}

std::optional<std::string> sha512_of(InputFile& file, const ArchivedFile& part,
                                     const std::atomic<bool>* stop) {
    crypto_hash_sha512_state state{};
    crypto_hash_sha512_init(&state);
    file.seek(part.begin);
    std::vector<std::byte> bytes(std::size_t{1} << 20);
    for (std::uint64_t left = part.size; left > 0; left -= bytes.size()) {
        if (stop != nullptr && *stop) {
            return std::nullopt;
        }
        bytes.resize(std::min<std::uint64_t>(left, bytes.size()));
        file.read(bytes, "the samples");
        crypto_hash_sha512_update(&state, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    }
    std::array<unsigned char, crypto_hash_sha512_BYTES> hash{};
    crypto_hash_sha512_final(&state, hash.data());
    return digits_of(hash);
}

std::optional<std::string> hash_fault(std::string_view told_hash, InputFile& file, const ArchivedFile& part,
                                      const std::atomic<bool>* stop) {
    const std::string told = lower_case(told_hash);
    const auto found = told.empty() ? std::nullopt : sha512_of(file, part, stop);
    return !found || *found == told ? std::nullopt
                                    : std::optional(fmt::format("found {}..., told {}", found->substr(0, 16),
                                                                quoted_briefly(told.substr(0, 16))));
}

std::string sigmf_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

SigmfFiles::SigmfFiles(const SigmfPaths& paths, const RecordingHead& head, std::vector<std::size_t> columns)
    : meta_path_(paths.meta),
      data_(paths.data, StagedFile::Devices::refused, columns.size() * sizeof(float)),
      columns_(std::move(columns)),
      all_columns_(head.columns.size()),
      global_(global_of(head, columns_)) {
    const OutputFile writable(meta_path_, StagedFile::Devices::refused);
}

void SigmfFiles::appear(const SigmfProgress& progress) {
    data_.require_replaceable();
    fs::remove(meta_path_);
    if (data_.is_closed()) {
        data_.commit();
    } else {
        data_.appear();
    }
    appeared_ = true;
    save_meta(progress);
}

void SigmfFiles::save_meta(const SigmfProgress& progress) {
    const std::string text = meta_text(progress);
    OutputFile file(meta_path_, StagedFile::Devices::refused);
    file.write(text);
    file.commit();
    hash_ = sha512(text);
}

void SigmfFiles::write(std::span<const double> values, const std::function<void()>& make_room) {
    floats_.resize(values.size() / all_columns_ * columns_.size());
    float* to = floats_.data();
    for (std::size_t row = 0; row < values.size(); row += all_columns_) {
        for (const std::size_t column : columns_) {
            *to++ = static_cast<float>(values[row + column]);
        }
    }
    const std::span<const std::byte> bytes = wire_bytes(floats_);
    if (!data_.fits(bytes.size())) {
        make_room();
    }
    data_.write(bytes);
}

void SigmfFiles::flush() {
    data_.require_present();
    data_.flush();
}

void SigmfFiles::close() {
    data_.require_present();
    data_.close();
}

std::int64_t SigmfFiles::rows() const noexcept {
    return static_cast<std::int64_t>(data_.size() / (columns_.size() * sizeof(float)));
}

fs::path SigmfFiles::keep(const SigmfProgress& progress) {
    fs::path file = data_.keep();
    if (hash_.empty()) {
        OutputFile meta(meta_path_, StagedFile::Devices::refused);
        meta.write(meta_text(progress));
        meta.flush();
        meta.keep();
    }
    return file;
}

void SigmfFiles::remove() noexcept {
    data_.abandon();
    if (appeared_) {
        std::error_code gone;
        fs::remove(meta_path_, gone);
    }
}

Json SigmfFiles::listed() const {
    return {{"name", meta_path_.stem().string()}, {"hash", hash_}};
}

std::string SigmfFiles::meta_text(const SigmfProgress& progress) const {
    constexpr std::string_view end = "\n  }\n}\n";
    std::string text = sigmf_text({{"global", global_}});
    text.resize(text.size() - end.size());
    if (progress.may_change) {
        text += fmt::format(",\n    \"hertzline:changes_until_sample\": {},\n    \"hertzline:changes\": {}",
                            progress.changes_until_sample, progress.changes.text());
    }
    return text + "\n  },\n  \"captures\": " + progress.captures.text() +
           ",\n  \"annotations\": " + progress.annotations.text() + "\n}\n";
}

}  // namespace hertzline::recordings
