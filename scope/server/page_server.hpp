#pragma once
// Serves the page over HTTP, and speaks with each page over a WebSocket. Has a thread of its own, so that no browser can delay
// who listens to the stream; what a page does not take in time is not made for it.

#include <cstdint>
#include <memory>
#include <string>
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

/// What is sent to a page at a time. The page answers it ("ack"), and is then ready for the next.
using PageTurn = std::vector<PagePart>;

/// What a page did.
struct PageEvent {
    enum class Kind {
        opened,
        said,   ///< the text is JSON from a browser, which is not trusted
        ready,  ///< it has taken its turn
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
    static constexpr std::size_t message_bytes = 16384;  ///< from a page
    static constexpr unsigned messages_per_s = 200;      ///< from a page
    static constexpr int answer_within_s = 5;            ///< or the page is dropped
};

/// For one thread.
class PageServer {
public:
    /// Binds and begins to serve. @throws std::runtime_error that names the address and what is wrong with it
    PageServer(PageAddress address, std::string token);
    /// Ends every connection.
    ~PageServer();
    PageServer(const PageServer&) = delete;
    PageServer& operator=(const PageServer&) = delete;

    /// The address to be opened, with the token.
    std::string url() const;

    /// Sends a turn to a page that is ready; nothing when it has gone.
    void deliver(PageId page, PageTurn turn);

    /// What pages did since this was asked before.
    std::vector<PageEvent> events();

    /// Pages that were dropped because they did not answer.
    std::uint64_t dropped_pages() const noexcept;

private:
    class Work;  // Beast stays out of the header
    std::unique_ptr<Work> work_;
};

}  // namespace hertzline::scope
