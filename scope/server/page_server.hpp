#pragma once
// Serves the page over HTTP, and exchanges messages with each page over a WebSocket. Has a thread of its own, so that no
// browser can delay the listening thread. A slow page gets fewer updates.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scope/server/page_rules.hpp"

namespace hertzline::scope {

using PageId = std::uint64_t;

/// One message to a page.
struct PagePart {
    enum class Kind { text, binary };
    Kind kind = Kind::text;
    std::string bytes;
};

/// The messages that are sent to a page at a time. The page acknowledges them ("ack"), and is then ready for more.
using PageUpdate = std::vector<PagePart>;

/// An act of a page.
struct PageEvent {
    enum class Kind {
        opened,
        asked,  ///< the text is JSON from a browser, which is not trusted
        ready,  ///< it has taken its update
        closed,
    };
    Kind kind = Kind::opened;
    PageId page = 0;
    std::string text{};
};

/// Limits of the server.
struct PageLimits {
    static constexpr std::size_t pages = 16;
    static constexpr std::size_t connections = 64;
    static constexpr std::size_t message_bytes = 65536;  ///< from a page
    static constexpr unsigned messages_per_s = 200;      ///< from a page
    static constexpr int answer_within_s = 5;            ///< or the page is dropped
};

/// A file of the page, which is part of the program.
struct PageFile {
    std::string_view name;  ///< "index.html"
    std::string_view type;  ///< "text/html; charset=utf-8"
    std::string_view text;
};

/// Returns the files of scope/page/. index.html stands for the page itself.
std::span<const PageFile> page_files() noexcept;

/// For one thread.
class PageServer {
public:
    /// Binds and begins to serve. @throws std::runtime_error with the address and its fault
    PageServer(PageAddress address, std::string token);
    /// Ends every connection.
    ~PageServer();
    PageServer(const PageServer&) = delete;
    PageServer& operator=(const PageServer&) = delete;

    /// Returns the address to be opened, with the token.
    std::string url() const;

    /// Sends an update to a page that is ready; does nothing when it has gone.
    void deliver(PageId page, PageUpdate update);

    /// Returns the acts of pages since the last call.
    std::vector<PageEvent> events();

    /// Returns the count of pages that were dropped because they did not acknowledge an update.
    std::uint64_t dropped_pages() const noexcept;

private:
    class Work;  // Beast stays out of the header
    std::unique_ptr<Work> work_;
};

}  // namespace hertzline::scope
