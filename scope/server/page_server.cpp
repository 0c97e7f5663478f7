#include "scope/server/page_server.hpp"

#include <algorithm>
#include <list>
#include <map>
#include <optional>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "scope/pictures/picture.hpp"
#include "scope/server/page_connection.hpp"

namespace hertzline::scope {

namespace {

using asio::ip::tcp;
using HttpAnswer = http::response<http::string_body>;

constexpr std::uint32_t most_header_bytes = 8192;
constexpr std::chrono::seconds request_within{10};

std::string_view view(boost::string_view text) {
    return {text.data(), text.size()};
}

PageRequest page_request(const HttpRequest& request) {
    const bool one_host = request.count(http::field::host) == 1;
    return {view(request.method_string()), view(request.target()),
            one_host ? view(request[http::field::host]) : std::string_view(),
            view(request[http::field::origin]), websocket::is_upgrade(request)};
}

/// Allows a page to load its own files alone, and no other page to hold it in a frame.
HttpAnswer answer(unsigned status, std::string_view type, std::string_view text, const HttpRequest& request) {
    HttpAnswer answer{static_cast<http::status>(status), request.version()};
    const std::string host(view(request[http::field::host]));
    answer.set(http::field::content_type, boost::string_view(type.data(), type.size()));
    answer.set("Content-Security-Policy",
               "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
               "connect-src 'self'" +
                   (status == 200 ? " ws://" + host + " wss://" + host : std::string()) +
                   "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    answer.set("X-Content-Type-Options", "nosniff");
    answer.set("Referrer-Policy", "no-referrer");
    answer.set("Cross-Origin-Resource-Policy", "same-origin");
    answer.set("Cross-Origin-Opener-Policy", "same-origin");
    answer.set(http::field::cache_control, "no-store");
    answer.keep_alive(request.keep_alive());
    if (request.method() == http::verb::head) {
        answer.content_length(text.size());
    } else {
        answer.body() = text;
        answer.prepare_payload();
    }
    return answer;
}

HttpAnswer file_answer(const std::string& name, const HttpRequest& request) {
    if (name == "protocol.js") {
        return answer(200, "text/javascript; charset=utf-8", protocol_script(), request);
    }
    const std::span<const PageFile> files = page_files();
    const auto file = std::ranges::find(files, name.empty() ? "index.html" : name, &PageFile::name);
    return file == files.end() ? answer(404, "text/plain", "There is no such file.", request)
                               : answer(200, file->type, file->text, request);
}

}  // namespace

/// For the server's thread, except construction and end.
class PageServer::Work {
public:
    Work(PageAddress address, std::string token)
        : address_(std::move(address)), token_(std::move(token)), acceptor_(context_) {
        try {
            const tcp::endpoint endpoint(asio::ip::make_address(address_.host), address_.port);
            acceptor_.open(endpoint.protocol());
            acceptor_.set_option(asio::socket_base::reuse_address(true));
            acceptor_.bind(endpoint);
            acceptor_.listen();
        } catch (const boost::system::system_error& error) {
            throw std::runtime_error(fmt::format("http://{}:{}: {}", host_in_url(address_), address_.port,
                                                 error.code().message()));
        }
        address_.port = acceptor_.local_endpoint().port();
        accept();
        thread_ = std::thread([this] { context_.run(); });
    }

    ~Work() {
        context_.stop();
        thread_.join();
    }

    const PageAddress& address() const noexcept { return address_; }
    const std::string& token() const noexcept { return token_; }
    PageEvents& events() const noexcept { return *events_; }

    void deliver(PageId page, PageUpdate update) {
        asio::post(context_, [this, page, update = std::move(update)]() mutable {
            const auto found = pages_.find(page);
            if (const auto connection = found == pages_.end() ? nullptr : found->second.lock()) {
                connection->deliver(std::move(update));
            }
        });
    }

private:
    class Visitor;

    void accept() {
        acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
            if (!error) {
                receive(std::move(socket));
            }
            accept_soon(error);
        });
    }
    /// Waits before it accepts again: without descriptors left it would fail at once.
    void accept_soon(beast::error_code error) {
        if (!error) {
            accept();
            return;
        }
        pause_.expires_after(std::chrono::milliseconds(100));
        pause_.async_wait([this](beast::error_code stopped) {
            if (!stopped) {
                accept();
            }
        });
    }
    void receive(tcp::socket socket);
    bool make_room();
    void open_page(beast::tcp_stream stream, HttpRequest request) {
        std::erase_if(pages_, [](const auto& page) { return page.second.expired(); });
        const auto connection = std::make_shared<PageConnection>(std::move(stream), ++last_page_, events_);
        pages_[last_page_] = connection;
        connection->accept(std::move(request));
    }
    bool is_full() const { return events_->pages >= PageLimits::pages; }

    PageAddress address_;
    std::string token_;
    std::shared_ptr<PageEvents> events_ = std::make_shared<PageEvents>();
    std::map<PageId, std::weak_ptr<PageConnection>> pages_;
    PageId last_page_ = 0;
    std::list<std::weak_ptr<Visitor>> visitors_;  // the oldest first
    asio::io_context context_{1};
    tcp::acceptor acceptor_;
    asio::steady_timer pause_{context_};
    std::thread thread_;
};

/// A connection that speaks HTTP.
class PageServer::Work::Visitor : public std::enable_shared_from_this<Visitor> {
public:
    Visitor(Work& work, tcp::socket&& socket)
        : work_(work), events_(work.events_), stream_(std::move(socket)) {
        ++events_->connections;
    }
    ~Visitor() { --events_->connections; }
    Visitor(const Visitor&) = delete;
    Visitor& operator=(const Visitor&) = delete;

    bool is_stranger() const noexcept { return !has_token_; }
    void close() { stream_.close(); }

    void read() {
        parser_.emplace();
        parser_->header_limit(most_header_bytes);
        stream_.expires_after(request_within);
        http::async_read(stream_, buffer_, *parser_,
                         [self = shared_from_this()](beast::error_code error, std::size_t /*bytes*/) {
                             if (!error) {
                                 self->take(self->parser_->release());
                             }
                         });
    }

private:
    void take(HttpRequest request) {
        const auto name = admitted(page_request(request), work_.address_, work_.token_);
        has_token_ = has_token_ || name.has_value();
        if (!name) {
            write(answer(name.error().status, "text/plain", name.error().text, request));
        } else if (!websocket::is_upgrade(request)) {
            write(file_answer(*name, request));
        } else if (*name != "socket") {
            write(answer(404, "text/plain", "There is no such socket.", request));
        } else if (work_.is_full()) {
            write(answer(503, "text/plain", "As many pages are open as this scope serves.", request));
        } else {
            work_.open_page(std::move(stream_), std::move(request));
        }
    }

    void write(HttpAnswer answer) {
        answer_ = std::move(answer);
        stream_.expires_after(request_within);
        http::async_write(stream_, answer_,
                          [self = shared_from_this()](beast::error_code error, std::size_t /*bytes*/) {
                              if (!error && self->answer_.keep_alive()) {
                                  self->read();
                              }
                          });
    }

    Work& work_;
    std::shared_ptr<PageEvents> events_;
    beast::tcp_stream stream_;
    beast::flat_buffer buffer_{most_header_bytes};
    std::optional<http::request_parser<http::empty_body>> parser_;
    HttpAnswer answer_;
    bool has_token_ = false;
};

void PageServer::Work::receive(tcp::socket socket) {
    // Else a part of an update would wait until the page's system has confirmed the one before, 40 ms.
    beast::error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    if (events_->connections < PageLimits::connections || make_room()) {
        const auto visitor = std::make_shared<Visitor>(*this, std::move(socket));
        std::erase_if(visitors_, [](const auto& each) { return each.expired(); });
        visitors_.push_back(visitor);
        visitor->read();
    }
}

/// Closes the oldest connection that has not shown the token. Returns whether there was one.
bool PageServer::Work::make_room() {
    for (auto each = visitors_.begin(); each != visitors_.end(); ++each) {
        if (const std::shared_ptr<Visitor> visitor = each->lock(); visitor && visitor->is_stranger()) {
            visitor->close();
            visitors_.erase(each);
            return true;
        }
    }
    return false;
}

PageServer::PageServer(PageAddress address, std::string token)
    : work_(std::make_unique<Work>(std::move(address), std::move(token))) {}

PageServer::~PageServer() = default;

std::string PageServer::url() const {
    return fmt::format("http://{}:{}/{}/", host_in_url(work_->address()), work_->address().port,
                       work_->token());
}

void PageServer::deliver(PageId page, PageUpdate update) {
    work_->deliver(page, std::move(update));
}

std::vector<PageEvent> PageServer::events() {
    PageEvents& events = work_->events();
    const std::scoped_lock lock(events.guard);
    return std::exchange(events.waiting, {});
}

std::uint64_t PageServer::dropped_pages() const noexcept {
    return work_->events().dropped_pages;
}

}  // namespace hertzline::scope
