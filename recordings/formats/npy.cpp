#include "recordings/formats/npy.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <exception>
#include <string>

#include "core/scene/json.hpp"
#include "recordings/checked_writer.hpp"
#include "recordings/files/output_file.hpp"
#include "recordings/formats/npy_header.hpp"
#include "recordings/recording_head.hpp"

namespace hertzline::recordings {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

std::size_t bytes_of(NumberType numbers) {
    return numbers == NumberType::float32 ? sizeof(float) : sizeof(double);
}

template <class Number>
void append_bytes(std::string& bytes, double value) {
    const auto number = static_cast<Number>(value);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

class NpyWriter final : public CheckedWriter {
public:
    NpyWriter(const std::filesystem::path& path, const RecordingHead& head)
        : CheckedWriter(path, head), file_(path, StagedFile::Devices::refused) {
        file_.write(header());
    }

private:
    std::string header() const { return header_of(static_cast<std::uint64_t>(rows())); }
    std::string header_of(std::uint64_t rows) const { return npy_header({npy_fields(head()), {rows}}); }

    std::string description() const {
        const std::string text = ascii_json_text(describe(head()));
        return npy_header({{{"", "|S" + std::to_string(text.size())}}, {}}) + text;
    }

    void append(std::int64_t first, std::span<const double> values) override {
        const std::size_t columns = head().columns.size();
        begun_rows_ = rows() + static_cast<std::int64_t>(values.size() / columns);
        bytes_.clear();
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (i % columns == 0) {  // counted, not accumulated
                const auto sample = first + static_cast<std::int64_t>(i / columns);
                append_bytes<double>(bytes_, static_cast<double>(sample) / head().sample_rate_hz);
            }
            head().numbers == NumberType::float32 ? append_bytes<float>(bytes_, values[i])
                                                  : append_bytes<double>(bytes_, values[i]);
        }
        file_.write(bytes_);
    }

    void finish() override {
        file_.write(description());
        file_.rewrite(0, header());
        file_.commit();
    }

    /// The last rows make room for the description when the disk is full.
    KeptRows rescue() override {
        if (file_.is_closed()) {
            return kept_as_it_is(rows());
        }
        const std::string text = description();
        const std::uint64_t begin = header().size();
        const std::uint64_t row_bytes = sizeof(double) + head().columns.size() * bytes_of(head().numbers);
        std::uint64_t room = file_.size();
        try {
            file_.flush();
            room = file_.size() + text.size();
        } catch (const std::exception&) {
            room = file_.size();
        }
        const std::uint64_t taken = begin + text.size();
        const std::uint64_t rows = std::min<std::uint64_t>(static_cast<std::uint64_t>(begun_rows_),
                                                           room < taken ? 0 : (room - taken) / row_bytes);
        if (rows == 0) {
            remove();
            return {};
        }
        file_.resume_at(begin + rows * row_bytes);
        file_.write(text);
        file_.rewrite(0, header_of(rows));
        return kept_as_it_is(static_cast<std::int64_t>(rows));
    }

    KeptRows kept_as_it_is(std::int64_t rows) {
        const std::filesystem::path temporary = file_.keep();
        return {file_.is_doubtful() ? 0 : rows, temporary};
    }

    void remove() noexcept override { file_.abandon(); }

    OutputFile file_;
    std::int64_t begun_rows_ = 0;  // the last of them may be in the file in part
    std::string bytes_;
};

}  // namespace

std::vector<NpyField> npy_fields(const RecordingHead& head) {
    const char* const type = head.numbers == NumberType::float32 ? "<f4" : "<f8";
    std::vector<NpyField> fields{{"t_s", "<f8"}};
    for (const Column& column : head.columns) {
        fields.push_back({column.name, type});
    }
    return fields;
}

std::unique_ptr<RecordingWriter> open_npy_writer(const std::filesystem::path& path,
                                                 const RecordingHead& head) {
    return std::make_unique<NpyWriter>(path, head);
}

}  // namespace hertzline::recordings
