#include "scope/server/page_connection.hpp"

#include <string_view>

namespace hertzline::scope {

namespace {

using std::chrono::steady_clock;

constexpr std::string_view answer_begins = R"({"ack")";

}  // namespace

PageConnection::PageConnection(beast::tcp_stream&& stream, PageId page, std::shared_ptr<PageEvents> events)
    : socket_(std::move(stream)), answer_(socket_.get_executor()), page_(page), events_(std::move(events)) {
    ++events_->pages;
    ++events_->connections;
}

PageConnection::~PageConnection() {
    --events_->pages;
    --events_->connections;
    if (open_) {
        events_->add({PageEvent::Kind::closed, page_});
    }
}

void PageConnection::accept(HttpRequest request) {
    request_ = std::move(request);
    beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has limits of its own
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = std::chrono::seconds(10);
    limits.idle_timeout = std::chrono::seconds(20);
    limits.keep_alive_pings = true;
    socket_.set_option(limits);
    socket_.read_message_max(PageLimits::message_bytes);
    socket_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
        if (error) {
            return;
        }
        self->open_ = true;
        self->events_->add({PageEvent::Kind::opened, self->page_});
        self->events_->add({PageEvent::Kind::ready, self->page_});
        self->read();
    });
}

void PageConnection::read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t /*bytes*/) {
        if (error || self->asks_too_often()) {
            self->close();
            return;
        }
        const std::string text = beast::buffers_to_string(self->buffer_.data());
        self->buffer_.consume(self->buffer_.size());
        self->take(text);
        self->read();
    });
}

bool PageConnection::asks_too_often() {
    const auto now = steady_clock::now();
    if (now - second_begins_ > std::chrono::seconds(1)) {
        second_begins_ = now;
        asked_in_second_ = 0;
    }
    return ++asked_in_second_ > PageLimits::messages_per_s;
}

void PageConnection::take(const std::string& text) {
    if (text.starts_with(answer_begins)) {
        take_answer();
    } else {
        events_->add({PageEvent::Kind::asked, page_, text});
    }
}

void PageConnection::take_answer() {
    if (waits_for_answer_ && parts_.empty()) {
        waits_for_answer_ = false;
        answer_.cancel();
        events_->add({PageEvent::Kind::ready, page_});
    }
}

void PageConnection::deliver(PageUpdate update) {
    if (!open_ || waits_for_answer_ || update.empty()) {
        return;
    }
    waits_for_answer_ = true;
    parts_.assign(std::make_move_iterator(update.begin()), std::make_move_iterator(update.end()));
    wait_for_answer();
    write();
}

void PageConnection::wait_for_answer() {
    answer_.expires_after(std::chrono::seconds(PageLimits::answer_within_s));
    answer_.async_wait([weak = weak_from_this()](beast::error_code error) {
        const auto self = weak.lock();
        if (!error && self && self->waits_for_answer_) {
            ++self->events_->dropped_pages;
            self->close();
        }
    });
}

void PageConnection::write() {
    socket_.binary(parts_.front().kind == PagePart::Kind::binary);
    socket_.async_write(asio::buffer(parts_.front().bytes),
                        [self = shared_from_this()](beast::error_code error, std::size_t /*bytes*/) {
                            if (error) {
                                self->close();
                                return;
                            }
                            self->parts_.pop_front();
                            if (!self->parts_.empty()) {
                                self->write();
                            }
                        });
}

/// Closes without a closing frame, which a page that does not read would not read, either.
void PageConnection::close() {
    answer_.cancel();
    beast::get_lowest_layer(socket_).close();
}

}  // namespace hertzline::scope
