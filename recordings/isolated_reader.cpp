#include "recordings/isolated_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "recordings/files/errors.hpp"
#include "recordings/recording_head.hpp"

#include "core/scene/json.hpp"
#include "core/scene/text.hpp"

namespace hertzline::recordings {

namespace {

enum class Kind : std::uint32_t { head, rows, end, fault };

/// The head of a message in the pipe; `size` bytes follow.
struct Message {
    Kind kind = Kind::end;
    NumberType numbers = NumberType::float32;  // of a head
    std::int64_t first = 0;                    // of rows
    std::uint64_t size = 0;                    // JSON, float64, nothing or text
};

constexpr std::uint64_t largest_head = std::uint64_t{256} << 20;  // that of a million spheres, and more
constexpr std::uint64_t largest_rows = std::uint64_t{1} << 20;    // or one row, if that is longer
constexpr std::uint64_t largest_fault = 1 << 16;
constexpr std::size_t longest_reason = 300;
constexpr std::int64_t max_sample = std::int64_t{1} << 62;  // sums of two stay in 64 bits

void send(Answers& answers, Message message, std::span<const std::byte> bytes) {
    message.size = bytes.size();
    answers.write(std::as_bytes(std::span(&message, 1)));
    answers.write(bytes);
}

void send(Answers& answers, Message message, const std::string& text) {
    send(answers, message, std::as_bytes(std::span(text)));
}

void send_recording(Answers& answers, RecordingReader& reader, std::size_t portion) {
    const RecordingHead& head = reader.head();
    send(answers, {.kind = Kind::head, .numbers = head.numbers}, text_of(describe(head)));
    const std::size_t row_bytes = head.columns.size() * sizeof(double);
    portion = std::clamp<std::size_t>(largest_rows / row_bytes, 1, portion);
    for (RecordedRows rows; reader.read(rows, portion);) {
        send(answers, {.kind = Kind::rows, .first = rows.first}, std::as_bytes(std::span(rows.values)));
    }
    send(answers, {.kind = Kind::end}, "");
}

[[noreturn]] void nonsense() {
    throw std::runtime_error("the process that reads it sent an invalid message");
}

class IsolatedReader final : public RecordingReader {
public:
    IsolatedReader(std::filesystem::path path, std::unique_ptr<ChildProcess> child)
        : path_(std::move(path)), child_(std::move(child)) {
        naming_the_path([this] { take_head(); });
    }

    const RecordingHead& head() const noexcept override { return head_; }

    bool read(RecordedRows& rows, std::size_t most) override {
        const std::size_t columns = head_.columns.size();
        if (taken_ == rows_.values.size()) {
            naming_the_path([this] { take_rows(); });
        }
        const std::size_t count = std::min((rows_.values.size() - taken_) / columns, most);
        const auto begin = rows_.values.begin() + static_cast<std::ptrdiff_t>(taken_);
        rows.first = rows_.first + static_cast<std::int64_t>(taken_ / columns);
        rows.values.assign(begin, begin + static_cast<std::ptrdiff_t>(count * columns));
        taken_ += count * columns;
        return count > 0;
    }

    void interrupt() noexcept override { child_->interrupt(); }

private:
    template <class Work>
    void naming_the_path(Work work) {
        try {
            work();
        } catch (const std::runtime_error& error) {
            ended_ = true;
            // The child names the path already, but is not trusted.
            const std::string reason = error.what();
            const std::string file = path_.string();
            const std::string refused = "cannot read " + file + ": ";
            if (reason.starts_with(file + ":")) {  // and the line
                throw std::runtime_error(file + printable(reason.substr(file.size()), longest_reason));
            }
            cannot_read(path_, reason.starts_with(refused) ? reason.substr(refused.size()) : reason);
        }
    }

    /// The next message. Unset `kind`: the reader was interrupted. @throws the error that the child reports
    Message take_message() {
        Message message;
        if (!child_->read(std::as_writable_bytes(std::span(&message, 1)))) {
            return {.kind = Kind::end};
        }
        if (message.kind == Kind::fault) {
            throw std::runtime_error(take_text(message.size, largest_fault));
        }
        return message;
    }

    /// Grows with the received bytes, not with the announced size.
    std::string take_text(std::uint64_t size, std::uint64_t most) {
        constexpr std::uint64_t step = 1 << 20;
        if (size > most) {
            nonsense();
        }
        std::string text;
        while (text.size() < size) {
            const std::size_t had = text.size();
            text.resize(std::min(size, had + step));
            if (!child_->read(std::as_writable_bytes(std::span(text).subspan(had)))) {
                throw std::runtime_error("interrupted");
            }
        }
        return text;
    }

    void take_head() {
        const Message message = take_message();
        const bool float32 = message.numbers == NumberType::float32;
        if (message.kind != Kind::head || !(float32 || message.numbers == NumberType::float64)) {
            nonsense();
        }
        head_ = described_head(json_from_outside(take_text(message.size, largest_head)), message.numbers);
        if (head_.columns.empty() || !(head_.sample_rate_hz >= 0) || !std::isfinite(head_.sample_rate_hz)) {
            nonsense();
        }
        for (Column& column : head_.columns) {
            column = {printable(column.name), printable(column.quantity), printable(column.unit)};
        }
    }

    void take_rows() {
        rows_.values.clear();
        taken_ = 0;
        if (ended_) {
            return;
        }
        const Message message = take_message();
        if (message.kind == Kind::end) {
            ended_ = true;
            return;
        }
        const std::uint64_t row_bytes = head_.columns.size() * sizeof(double);
        if (message.kind != Kind::rows || message.size == 0 || message.size % row_bytes != 0 ||
            message.size > std::max(row_bytes, largest_rows) || message.first < due_ ||
            message.first > max_sample) {
            nonsense();
        }
        rows_.first = message.first;
        rows_.values.resize(message.size / sizeof(double));
        if (!child_->read(std::as_writable_bytes(std::span(rows_.values)))) {
            rows_.values.clear();
            ended_ = true;
            return;
        }
        const auto count = static_cast<std::int64_t>(message.size / row_bytes);
        require_undamaged(path_, row_, rows_.values, head_.columns.size());
        row_ += count;
        due_ = rows_.first + count;
    }

    std::filesystem::path path_;
    std::unique_ptr<ChildProcess> child_;
    RecordingHead head_;
    RecordedRows rows_;      // of the last message
    std::size_t taken_ = 0;  // numbers of them that were handed on
    std::int64_t row_ = 0;   // of the recording, the next one
    std::int64_t due_ = 0;   // the sample that follows
    bool ended_ = false;
};

}  // namespace

ChildProcess::Work reading(std::function<std::unique_ptr<RecordingReader>()> open, std::size_t portion) {
    return [open = std::move(open), portion](Answers& answers) {
        try {
            send_recording(answers, *open(), portion);
        } catch (const std::bad_alloc&) {
            send(answers, {.kind = Kind::fault}, "it needs more memory than a recording may");
        } catch (const std::exception& error) {
            send(answers, {.kind = Kind::fault}, error.what());
        }
    };
}

std::unique_ptr<RecordingReader> open_isolated_reader(const std::filesystem::path& path,
                                                      std::unique_ptr<ChildProcess> child) {
    return std::make_unique<IsolatedReader>(path, std::move(child));
}

}  // namespace hertzline::recordings
