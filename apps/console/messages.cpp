#include "apps/console/messages.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "apps/console/standard_stream.hpp"
#include "core/scene/text.hpp"

namespace hertzline::app {

namespace {

std::string_view environment(const char* variable) {
    const char* value = std::getenv(variable);
    return value == nullptr ? "" : value;
}

constexpr std::size_t max_kept = std::size_t{1} << 16;  // bytes

/// Stderr with the text that it has not taken yet.
class Messages {
public:
    Messages() : stream_(STDERR_FILENO) { kept_.reserve(max_kept); }

    void write(std::string_view text) noexcept {
        if (kept_.size() + text.size() <= max_kept) {
            kept_.append(text);  // within the reserved size
        }
        pass_on();
    }

    void write_if_read(std::string_view text) noexcept {
        pass_on();
        if (kept_.empty()) {
            write(text);
        }
    }

    void finish() noexcept {
        stream_.write(kept_);
        kept_.clear();
    }

private:
    void pass_on() noexcept {
        std::string_view left = kept_;
        const int error = stream_.write_some(left);
        // Without stderr no message is possible.
        kept_.erase(0, error == 0 || error == EAGAIN ? kept_.size() - left.size() : kept_.size());
    }

    StandardStream stream_;
    std::string kept_;
};

Messages& messages() noexcept {
    static Messages all;
    return all;
}

ssize_t take(void* /*cookie*/, const char* text, std::size_t size) {
    messages().write({text, size});
    return static_cast<ssize_t>(size);
}

/// A message with '?' for each character that a terminal acts on, but for the ends of lines.
class PlainMessage final : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm& /*time*/,
                spdlog::memory_buf_t& formatted) override {
        std::string_view separator;
        for (const std::string_view line : split({message.payload.data(), message.payload.size()}, '\n')) {
            formatted.append(separator);
            formatted.append(printable_whole(line));
            separator = "\n";
        }
    }
    std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
        return std::make_unique<PlainMessage>();
    }
};

}  // namespace

bool stderr_is_terminal() {
    const std::string_view kind = environment("TERM");
    return ::isatty(STDERR_FILENO) == 1 && !kind.empty() && kind != "dumb";
}

void send_messages_to_stderr() {
    // spdlog's sink writes to a FILE; this one leads here.
    std::FILE* const file =
        ::fopencookie(nullptr, "w", {.read = nullptr, .write = take, .seek = nullptr, .close = nullptr});
    const bool colourful = stderr_is_terminal() && environment("NO_COLOR").empty();  // https://no-color.org
    const auto colour = colourful ? spdlog::color_mode::always : spdlog::color_mode::never;
    using Sink = spdlog::sinks::ansicolor_sink<spdlog::details::console_nullmutex>;
    auto logger = std::make_shared<spdlog::logger>("hertzline", std::make_shared<Sink>(file, colour));
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<PlainMessage>('*').set_pattern("%^%l%$: %*");
    logger->set_formatter(std::move(formatter));
    spdlog::set_default_logger(std::move(logger));
    // A reader that goes away is an error of writing, with a message and a clean end, not a sudden death.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // so is a file that is larger than allowed
}

void write_message(std::string_view text) noexcept {
    messages().write(text);
}

void write_if_read(std::string_view text) noexcept {
    messages().write_if_read(text);
}

void finish_messages() noexcept {
    messages().finish();
}

}  // namespace hertzline::app
