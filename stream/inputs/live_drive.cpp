#include "stream/inputs/live_drive.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <pthread.h>

#include "core/model/drive.hpp"
#include "core/scene/scene_words.hpp"
#include "core/scene/text.hpp"
#include "stream/wire/endpoint.hpp"

namespace hertzline::stream {

namespace {

constexpr double least_slack_s = 1e-3;  // the time that a wake-up takes on a busy machine
constexpr double longest_gap_s = 10;
constexpr int most_waiting = 64;             // messages of each sender
constexpr int most_waiting_of_sub = 10'000;  // those beyond are lost

DriveMessages::Limits limits_of(const Drive& drive) {
    // a horn that goes further, or faster, is none, and float32 holds much more
    const double largest = drive.quantity == DriveQuantity::velocity ? 1e5 : 1;
    const double rate = *drive.sample_rate_hz;
    const char* const unit = drive.quantity == DriveQuantity::velocity ? "m/s" : "m";
    return {.sample_rate_hz = rate,
            .largest = largest / std::abs(drive.scale.value_or(1)),
            .longest_gap = static_cast<std::size_t>(std::ceil(longest_gap_s * rate)),
            .unit = drive.scale ? "" : unit,
            .topics = drive.socket == DriveSocket::pull};
}

/// Whether an occupied ipc endpoint is that of a program, and no other file.
bool is_answered(const std::string& address) {
    constexpr std::string_view ipc = "ipc://";
    std::error_code error;
    return address.starts_with(ipc) && std::filesystem::is_socket(address.substr(ipc.size()), error);
}

/// An endpoint without its prefix.
struct DriveEndpoint {
    std::string address;
    std::optional<bool> binds;  ///< unset: as the socket usually does
};

DriveEndpoint endpoint_of(const Drive& drive) {
    for (const auto& [prefix, binds] : {std::pair{std::string_view("bind:"), true}, {"connect:", false}}) {
        if (drive.endpoint.starts_with(prefix)) {
            return {drive.endpoint.substr(prefix.size()), binds};
        }
    }
    return {drive.endpoint, std::nullopt};
}

/// By how much the latency is longer than it has to be.
double spare_s(const Scene& scene) {
    Scene shortest = scene;
    shortest.drive.start_s = 0;
    return scene.drive.start_s - with_latency(shortest).drive.start_s;
}

}  // namespace

std::optional<Fault> LiveDrive::fault_of(const Drive& drive) {
    const DriveEndpoint endpoint = endpoint_of(drive);
    const bool binds = endpoint.binds.value_or(drive.socket == DriveSocket::pull);
    const auto fault = endpoint_fault(endpoint.address, binds ? EndpointUse::bind : EndpointUse::connect);
    return fault ? std::optional(Fault{"drive.endpoint", *fault, ""}) : std::nullopt;
}

LiveDrive::LiveDrive(const Scene& scene, Keep keep)
    : drive_(scene.drive),
      output_rate_(scene.output.sample_rate_hz),
      reach_s_(reach_beyond_sample_s(scene)),
      slack_s_(std::max(least_slack_s, spare_s(scene))),
      keep_(std::move(keep)),
      motion_(std::make_shared<LiveMotion>(
          scene.drive, 4 * (static_cast<double>(scene.output.frame_samples) / output_rate_ + reach_s_))),
      messages_(limits_of(scene.drive)),
      socket_(context_, drive_.socket == DriveSocket::pull ? zmq::socket_type::pull : zmq::socket_type::sub) {
    open();
    last_at_ = MonotonicClock::now();
    thread_ = std::thread([this] {
        pthread_setname_np(pthread_self(), driving_thread_name);
        serve();
    });
}

LiveDrive::~LiveDrive() {
    stop();
}

void LiveDrive::stop() noexcept {
    interrupt();
    if (thread_.joinable()) {
        thread_.join();
    }
}

/// Binds or connects. A pull socket binds, but connects where a sender has bound the endpoint, as GNU Radio's sinks do.
void LiveDrive::open() {
    if (const auto fault = fault_of(drive_)) {
        throw std::runtime_error(fault->message());
    }
    const auto [address, asked] = endpoint_of(drive_);
    const bool pulls = drive_.socket == DriveSocket::pull;
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::rcvhwm, pulls ? most_waiting : most_waiting_of_sub);
    if (!pulls) {
        socket_.set(zmq::sockopt::subscribe, drive_.column ? *drive_.column + "/np" : std::string());
    }
    try {
        const bool binds = asked.value_or(pulls);
        const auto occupied = binds ? occupied_fault(address) : std::nullopt;
        const bool taken = occupied && is_answered(address);
        if (occupied && (asked || !taken)) {
            throw std::runtime_error(*occupied);
        }
        if (binds && !taken) {
            socket_.set(zmq::sockopt::ipv6, is_ipv6(address));
            try {
                socket_.bind(bind_address(address));
                endpoint_ = socket_.get(zmq::sockopt::last_endpoint);
                return;
            } catch (const zmq::error_t& error) {
                if (asked || error.num() != EADDRINUSE) {
                    throw;
                }
            }
        }
        socket_.set(zmq::sockopt::ipv6, reached_over_ipv6(address).value_or(false));
        socket_.connect(address);
        endpoint_ = address;
        found_it_bound_ = binds;
    } catch (const zmq::error_t& error) {
        throw std::runtime_error(fmt::format("drive.endpoint \"{}\": {}", drive_.endpoint, error.what()));
    }
}

void LiveDrive::serve() noexcept {
    try {
        std::array<zmq::message_t, DriveMessages::most_parts + 1> parts;
        while (!stopping()) {
            zmq_pollitem_t item{.socket = socket_.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
            zmq_poll(&item, 1, patience_ms());
            for (std::size_t count = receive_parts(socket_, parts); count > 0 && !stopping();
                 count = receive_parts(socket_, parts)) {
                take(std::span(parts).first(std::min(count, parts.size())));
            }
            if (!stopping()) {
                fill_underrun();
                warn_of_silence();
            }
        }
    } catch (const std::exception& error) {
        const std::scoped_lock lock(mutex_);
        failure_ = fmt::format("the drive has ended: {}", error.what());
        failed_.store(true, std::memory_order_release);
    }
    filling_.wake();
}

/// Until there may be an underrun to be filled.
long LiveDrive::patience_ms() const noexcept {
    if (drive_.on_underrun == OnUnderrun::wait || !begun_) {
        return nap_ms;
    }
    const double due_s = static_cast<double>(received_) / *drive_.sample_rate_hz + slack_s_;
    const double left_s = due_s - seconds(MonotonicClock::now() - first_at_);
    return std::clamp(static_cast<long>(std::ceil(1e3 * left_s)), 1L, nap_ms);
}

void LiveDrive::warn_once(bool& warned, const std::string& text) {
    if (!std::exchange(warned, true)) {
        const std::scoped_lock lock(mutex_);
        warnings_.push_back(text);
    }
}

void LiveDrive::take(std::span<const zmq::message_t> parts) {
    const auto read = messages_.read(parts);
    if (!read) {
        refused_.fetch_add(1, std::memory_order_relaxed);
        warn_once(warned_of_refused_, "the drive: " + printable(read.error(), 300) +
                                          "; the message is left out, as further ones, which are counted in "
                                          "drive_refused");
        return;
    }
    if (read->lost > 0) {
        lost_.fetch_add(read->lost, std::memory_order_relaxed);
        warn_once(warned_of_lost_,
                  fmt::format("the drive: {} samples were lost on the way; {}, and they are "
                              "counted in drive_lost",
                              read->lost,
                              read->zeros > 0 ? "0 takes their place" : "what follows takes their place"));
        push_zeros(read->zeros);
    }
    warn_of_size();
    note_arrival(messages_.samples().size());
    push(messages_.samples());
}

/// Warns of samples in another unit than they are taken for.
void LiveDrive::warn_of_size() {
    const bool velocity = drive_.quantity == DriveQuantity::velocity;
    const double suspicious = velocity ? 100 : 1e-3;
    if (warned_of_size_) {
        return;
    }
    double largest = 0;
    for (const float sample : messages_.samples()) {
        largest = std::max(largest, std::abs(static_cast<double>(sample)));
    }
    largest *= std::abs(drive_.scale.value_or(1));
    if (largest >= suspicious) {
        warn_once(
            warned_of_size_,
            fmt::format(
                "the drive: a sample of {:g} {}; were {} (drive.scale), or a {} (drive.quantity), meant?",
                largest, velocity ? "m/s" : "m", velocity ? "millimetres a second" : "micrometres",
                velocity ? "displacement" : "velocity"));
    }
}

/// A stream that gives nothing, for want of samples, says so.
void LiveDrive::warn_of_silence() {
    constexpr Nanoseconds long_s = std::chrono::seconds(2);
    if (MonotonicClock::now() - last_at_ <= long_s) {
        return;
    }
    if (!begun_) {
        warn_once(
            warned_of_silence_,
            fmt::format("the drive: no samples have come to {} yet, for which the stream waits", endpoint_));
    } else if (drive_.on_underrun == OnUnderrun::wait) {
        warn_once(warned_of_pause_,
                  fmt::format("the drive: no samples have come to {} for 2 s, the stream waits for more",
                              endpoint_));
    }
}

/// Compares the time of the samples with the clock, which begins with the first one.
void LiveDrive::note_arrival(std::size_t samples) {
    if (samples == 0) {
        return;
    }
    const Nanoseconds now = MonotonicClock::now();
    last_at_ = now;
    if (!std::exchange(begun_, true)) {
        first_at_ = now;
        return;
    }
    const double late_s = seconds(now - first_at_) - static_cast<double>(received_) / *drive_.sample_rate_hz;
    if (drive_.on_underrun == OnUnderrun::wait && late_s > slack_s_) {
        underruns_.fetch_add(1, std::memory_order_relaxed);
        first_at_ += Nanoseconds(static_cast<std::int64_t>(late_s * 1e9));
    }
}

void LiveDrive::fill_underrun() {
    if (drive_.on_underrun == OnUnderrun::wait || !begun_) {
        return;
    }
    const double due = (seconds(MonotonicClock::now() - first_at_) - slack_s_) * *drive_.sample_rate_hz;
    if (due >= static_cast<double>(received_) + 1) {
        const std::uint64_t missing = static_cast<std::uint64_t>(due) - received_;
        underruns_.fetch_add(1, std::memory_order_relaxed);
        warn_once(warned_of_underruns_,
                  fmt::format("the drive: samples came too late, and 0 took the place of {}; "
                              "further ones are counted in drive_underruns and drive_zeros",
                              missing));
        filled_.fetch_add(push_zeros(missing), std::memory_order_relaxed);
    }
}

/// @returns how many of them it took: fewer when the drive was stopped
std::uint64_t LiveDrive::push_zeros(std::uint64_t samples) {
    const std::uint64_t before = received_;
    while (received_ - before < samples && !stopping()) {
        push(std::span(zeros_).first(std::min<std::uint64_t>(samples - (received_ - before), zeros_.size())));
    }
    return received_ - before;
}

void LiveDrive::push(std::span<const float> samples) {
    while (!samples.empty()) {
        const auto portion = samples.first(std::min(samples.size(), LiveMotion::portion));
        if (!motion_->has_room()) {  // then the samples wait for the simulation, not the other way round
            const Nanoseconds since = MonotonicClock::now();
            emptying_.wait_until(never, [this] { return motion_->has_room() || stopping(); });
            const Nanoseconds waited = MonotonicClock::now() - since;
            first_at_ += waited;
            last_at_ += waited;
        }
        if (stopping()) {
            return;
        }
        keep(portion);
        motion_->append(portion);
        received_ += portion.size();
        taken_.fetch_add(portion.size(), std::memory_order_relaxed);
        filling_.wake();
        samples = samples.subspan(portion.size());
    }
}

/// Where the samples cannot be kept, the stream goes on without.
void LiveDrive::keep(std::span<const float> samples) {
    if (!keep_) {
        return;
    }
    try {
        keep_(samples);
    } catch (const std::runtime_error& error) {
        keep_ = nullptr;
        const std::scoped_lock lock(mutex_);
        warnings_.push_back(fmt::format(
            "the drive: {}; the stream continues, but cannot be simulated again from its recordings",
            error.what()));
    }
}

double LiveDrive::time_of(std::int64_t output_sample) const noexcept {
    return static_cast<double>(output_sample) / output_rate_ - drive_.start_s;
}

bool LiveDrive::wait_for(std::int64_t output_sample) noexcept {
    const double needed_s = time_of(output_sample) + reach_s_;
    const auto ended = [this] { return stopping() || failed_.load(std::memory_order_acquire); };
    filling_.wait_until(never,
                        [&] { return motion_->known_until_s() > needed_s || needed_s < 0 || ended(); });
    return !ended() && !motion_->overtaken();
}

void LiveDrive::release(std::int64_t output_sample) noexcept {
    motion_->release(time_of(output_sample) - reach_s_);
    emptying_.wake_if([this] { return motion_->has_room(); });
}

void LiveDrive::interrupt() noexcept {
    stopping_.store(true, std::memory_order_relaxed);
    filling_.wake();
    emptying_.wake();
}

DriveCounts LiveDrive::counts() const noexcept {
    return {.samples = taken_.load(std::memory_order_relaxed),
            .underruns = underruns_.load(std::memory_order_relaxed),
            .zeros = filled_.load(std::memory_order_relaxed),
            .lost = lost_.load(std::memory_order_relaxed),
            .refused = refused_.load(std::memory_order_relaxed)};
}

std::vector<std::string> LiveDrive::take_warnings() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(warnings_, {});
}

std::string LiveDrive::failure() const {
    if (motion_->overtaken()) {
        return "the drive: the simulation went beyond the samples that had come";
    }
    const std::scoped_lock lock(mutex_);
    return failure_;
}

}  // namespace hertzline::stream
