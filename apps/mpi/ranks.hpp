#pragma once
// The processes that mpirun has started, and messages between them. All that there is of MPI is behind this.
//
// Nobody waits inside MPI: its waiting takes a whole processor, which a point could have.

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hertzline::app {

/// What a message is.
enum class Tag : int {
    ready,    ///< to rank 0: a text, what is wrong with the sweep here; empty: nothing
    points,   ///< of rank 0: points to be run, i64 each
    rows,     ///< to rank 0: a parcel of rows
    stopped,  ///< to rank 0: the user has stopped this rank
    failed,   ///< to rank 0: a text, why this rank cannot go on
    end,      ///< of rank 0: there is no more to do
    bye,      ///< to rank 0: the last message of this rank
};

struct Message {
    int from = 0;
    Tag tag = Tag::end;
    std::vector<std::byte> bytes;

    std::string text() const;
};

/// One object in a process, of its first thread. MPI ends the program when a rank is lost.
class Ranks {
public:
    /// @throws std::runtime_error when MPI does not begin
    Ranks();
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    int rank() const noexcept;
    int count() const noexcept;
    /// Those on this machine.
    int count_here() const noexcept;
    /// "rank 3 on node-b"
    std::string name() const;

    /// Gives all ranks the text of rank 0, at most 1 GiB. All have to call it.
    std::string share(std::string text);

    /// Returns at once.
    void send(int to, Tag tag, std::span<const std::byte> bytes);
    void send(int to, Tag tag, const std::string& text);

    /// A message that is there.
    std::optional<Message> receive();

    /// Waits until all that was sent is on its way, and no longer needed here.
    void finish_sending();

    /// How long who waits for a message sleeps before it looks again.
    static constexpr auto between_looks = std::chrono::milliseconds(2);

    /// Ends all ranks at once.
    [[noreturn]] void abort(int status);

private:
    struct Requests;
    std::unique_ptr<Requests> requests_;
};

}  // namespace hertzline::app
