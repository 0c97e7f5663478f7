#include "apps/mpi/ranks.hpp"

#include <cstdint>
#include <cstdlib>
#include <deque>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <mpi.h>

namespace hertzline::app {

namespace {

int number_of(int (*ask)(MPI_Comm, int*), MPI_Comm ranks) {
    int number = 0;
    ask(ranks, &number);
    return number;
}

void wait_for(MPI_Request request) {
    for (int done = 0; done == 0;) {
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done == 0) {
            std::this_thread::sleep_for(Ranks::between_looks);
        }
    }
}

}  // namespace

std::string Message::text() const {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What is being sent, in order.
struct Ranks::Requests {
    struct Sent {
        std::vector<std::byte> bytes;
        MPI_Request request = MPI_REQUEST_NULL;
    };
    std::deque<Sent> sent;  // whose elements stay where they are
    int here = 1;

    /// Forgets what has gone.
    void look() {
        for (int done = 1; !sent.empty();) {
            MPI_Test(&sent.front().request, &done, MPI_STATUS_IGNORE);
            if (done == 0) {
                return;
            }
            sent.pop_front();
        }
    }
};

Ranks::Ranks() : requests_(std::make_unique<Requests>()) {
    int there = 0;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &there) != MPI_SUCCESS ||
        there < MPI_THREAD_FUNNELED) {
        throw std::runtime_error("MPI cannot be used beside threads");
    }
    MPI_Comm here = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
    requests_->here = number_of(MPI_Comm_size, here);
    MPI_Comm_free(&here);
}

Ranks::~Ranks() {
    MPI_Finalize();
}

int Ranks::rank() const noexcept {
    return number_of(MPI_Comm_rank, MPI_COMM_WORLD);
}

int Ranks::count() const noexcept {
    return number_of(MPI_Comm_size, MPI_COMM_WORLD);
}

int Ranks::count_here() const noexcept {
    return requests_->here;
}

std::string Ranks::name() const {
    std::string node(MPI_MAX_PROCESSOR_NAME, '\0');
    int size = 0;
    MPI_Get_processor_name(node.data(), &size);
    node.resize(static_cast<std::size_t>(size));
    return fmt::format("rank {} on {}", rank(), node);
}

// The checker does not know that MPI_Test waits, too: in wait_for() and look().
// NOLINTBEGIN(clang-analyzer-optin.mpi.MPI-Checker)

std::string Ranks::share(std::string text) {
    std::uint64_t size = text.size();
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD, &request);
    wait_for(request);
    text.resize(size);
    MPI_Ibcast(text.data(), static_cast<int>(size), MPI_BYTE, 0, MPI_COMM_WORLD, &request);
    wait_for(request);
    return text;
}

void Ranks::send(int to, Tag tag, std::span<const std::byte> bytes) {
    Requests::Sent& sent = requests_->sent.emplace_back();
    sent.bytes.assign(bytes.begin(), bytes.end());
    MPI_Isend(sent.bytes.data(), static_cast<int>(sent.bytes.size()), MPI_BYTE, to, static_cast<int>(tag),
              MPI_COMM_WORLD, &sent.request);
}

void Ranks::send(int to, Tag tag, const std::string& text) {
    send(to, tag, std::as_bytes(std::span(text)));
}

// NOLINTEND(clang-analyzer-optin.mpi.MPI-Checker)

std::optional<Message> Ranks::receive() {
    requests_->look();
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there == 0) {
        return std::nullopt;
    }
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Message message{status.MPI_SOURCE, static_cast<Tag>(status.MPI_TAG),
                    std::vector<std::byte>(static_cast<std::size_t>(size))};
    MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.from, status.MPI_TAG, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    return message;
}

void Ranks::finish_sending() {
    while (requests_->look(), !requests_->sent.empty()) {
        std::this_thread::sleep_for(between_looks);
    }
}

void Ranks::abort(int status) {
    MPI_Abort(MPI_COMM_WORLD, status);
    std::_Exit(status);
}

}  // namespace hertzline::app
