#include "recordings/recording_thread.hpp"

#include <atomic>
#include <csignal>
#include <exception>
#include <utility>

#include <pthread.h>

namespace hertzline::recordings {

namespace {

std::atomic<bool> abandoned{false};

std::size_t bytes_of(const SharedRows& rows) noexcept {
    return rows->values.size() * sizeof(double);
}

/// Returns the text of the action's exception; empty: none.
template <class Action>
std::string failure_of(Action action) {
    try {
        action();
        return {};
    } catch (const std::exception& error) {
        return error.what();
    }
}

/// A pipe without a reader is then no more than an error.
void leave_signals_to_others() noexcept {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, nullptr);
}

void end_writer(RecordingWriter& writer, RecordingEnd how) {
    switch (how) {
        case RecordingEnd::commit:
            return writer.commit();
        case RecordingEnd::keep:
            return writer.keep();
        case RecordingEnd::discard:
            return writer.discard();
    }
}

}  // namespace

RecordingThread::RecordingThread(std::unique_ptr<RecordingWriter> writer, std::size_t max_bytes)
    : shared_(std::make_shared<Shared>()) {
    shared_->writer = std::move(writer);
    shared_->max_bytes = max_bytes;
    thread_ = std::thread([shared = shared_] {
        pthread_setname_np(pthread_self(), "recording");
        leave_signals_to_others();
        work(*shared);
    });
}

RecordingThread::~RecordingThread() {
    if (over()) {
        thread_.join();
    } else {
        hurry();
        abandoned = true;
        thread_.detach();
    }
}

bool RecordingThread::any_abandoned() noexcept {
    return abandoned;
}

std::int64_t RecordingThread::Shared::waiting_numbers() const {
    std::int64_t waiting = 0;
    for (const SharedRows& rows : queue) {
        waiting += static_cast<std::int64_t>(rows->values.size());
    }
    return waiting;
}

void RecordingThread::work(Shared& shared) {
    std::unique_lock lock(shared.mutex);
    write_queue(shared, lock);
    shared.result.unwritten_numbers = shared.waiting_numbers();
    shared.queue.clear();
    RecordingResult result = shared.result;
    const RecordingEnd how = shared.ending.value_or(RecordingEnd::keep);
    lock.unlock();
    if (result.failure.empty()) {
        result.failure = failure_of([&] { end_writer(*shared.writer, how); });
    }
    result.kept = shared.writer->kept();
    result.warning = shared.writer->warning();
    shared.writer.reset();  // closes its file
    lock.lock();
    shared.result = std::move(result);
    shared.over = true;
    shared.done.notify_all();
}

/// Writes until the end has come and the queue is empty, or something fails.
void RecordingThread::write_queue(Shared& shared, std::unique_lock<std::mutex>& lock) {
    for (;;) {
        shared.news.wait(lock, [&] { return !shared.queue.empty() || shared.ending || shared.hurry; });
        if (shared.queue.empty() || shared.hurry || shared.ending == RecordingEnd::discard) {
            return;
        }
        const SharedRows rows = shared.queue.front();
        lock.unlock();
        std::string failure = failure_of([&] {
            rows->change.is_null() ? shared.writer->write(rows->first, rows->values)
                                   : shared.writer->note_change(rows->change);
        });
        lock.lock();
        shared.queue.pop_front();
        shared.bytes -= bytes_of(rows);
        shared.numbers += static_cast<std::int64_t>(rows->values.size());
        shared.done.notify_all();
        if (!failure.empty()) {
            shared.result.failure = std::move(failure);
            return;
        }
    }
}

bool RecordingThread::try_write(const SharedRows& rows) {
    const std::scoped_lock lock(shared_->mutex);
    // Once it was full half of it must be free: one long gap is better than many short ones.
    const std::size_t allowed = shared_->full ? shared_->max_bytes / 2 : shared_->max_bytes;
    const bool full = !shared_->queue.empty() && shared_->bytes + bytes_of(rows) > allowed;
    if (rows->change.is_null()) {
        shared_->full = full;
    }
    if ((full && rows->change.is_null()) || shared_->over || !shared_->result.failure.empty()) {
        return false;
    }
    shared_->queue.push_back(rows);
    shared_->bytes += bytes_of(rows);
    shared_->news.notify_one();
    return true;
}

bool RecordingThread::wait_for_progress(Duration most) {
    std::unique_lock lock(shared_->mutex);
    const std::int64_t before = shared_->numbers;
    const auto progressed = [&] {  // a queue that was full may be empty by now
        return shared_->numbers != before || (shared_->queue.empty() && shared_->result.failure.empty());
    };
    shared_->done.wait_for(lock, most, [&] { return progressed() || shared_->over; });
    return progressed();
}

void RecordingThread::end(RecordingEnd how) {
    const std::scoped_lock lock(shared_->mutex);
    shared_->ending = how;
    shared_->news.notify_one();
}

void RecordingThread::hurry() {
    const std::scoped_lock lock(shared_->mutex);
    shared_->hurry = true;
    shared_->news.notify_one();
}

bool RecordingThread::wait_for_end(Duration most) {
    std::unique_lock lock(shared_->mutex);
    return shared_->done.wait_for(lock, most, [&] { return shared_->over; });
}

bool RecordingThread::failed() const {
    const std::scoped_lock lock(shared_->mutex);
    return !shared_->result.failure.empty();
}

bool RecordingThread::over() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->over;
}

RecordingResult RecordingThread::result() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->result;
}

std::int64_t RecordingThread::numbers() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->numbers;
}

std::int64_t RecordingThread::waiting_numbers() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->waiting_numbers();
}

}  // namespace hertzline::recordings
