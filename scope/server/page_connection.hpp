#pragma once
// One page's WebSocket. Beast's headers are large: included by this and page_server.cpp alone.

// before <boost/asio.hpp>, which uses std::exchange without it
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "scope/server/page_server.hpp"

namespace hertzline::scope {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

/// The acts of pages, on their way from the server's thread to the listening one.
struct PageEvents {
    std::mutex guard;
    std::vector<PageEvent> waiting;
    std::atomic<std::uint64_t> dropped_pages{0};
    std::atomic<std::size_t> connections{0};
    std::atomic<std::size_t> pages{0};

    void add(PageEvent event) {
        const std::scoped_lock lock(guard);
        waiting.push_back(std::move(event));
    }
};

using HttpRequest = http::request<http::empty_body>;

/// A page's connection; lives as long as its socket. For the server's thread.
class PageConnection : public std::enable_shared_from_this<PageConnection> {
public:
    PageConnection(beast::tcp_stream&& stream, PageId page, std::shared_ptr<PageEvents> events);
    ~PageConnection();
    PageConnection(const PageConnection&) = delete;
    PageConnection& operator=(const PageConnection&) = delete;

    /// Answers the request for a WebSocket.
    void accept(HttpRequest request);
    void deliver(PageUpdate update);
    void close();

private:
    void read();
    void take(const std::string& text);
    void take_answer();
    void write();
    bool asks_too_often();
    void wait_for_answer();

    websocket::stream<beast::tcp_stream> socket_;
    asio::steady_timer answer_;
    beast::flat_buffer buffer_;
    HttpRequest request_;
    PageId page_;
    std::shared_ptr<PageEvents> events_;
    std::deque<PagePart> parts_;  // of the update, that are still to be written
    bool waits_for_answer_ = false;
    bool open_ = false;
    std::chrono::steady_clock::time_point second_begins_;
    unsigned asked_in_second_ = 0;
};

}  // namespace hertzline::scope
