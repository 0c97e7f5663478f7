// Requests of a page for views, line by line, and the pictures of a short stretch of samples for them.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/bursts.hpp"
#include "core/scene/json.hpp"
#include "scope/pictures/picture.hpp"
#include "scope/pictures/view.hpp"
#include "stream/wire/frame_codec.hpp"
#include "tests/fuzz/claim.hpp"

namespace hertzline::fuzz {

using namespace scope;
using namespace stream;

namespace {

constexpr std::size_t longest_message = 500;
constexpr double fs = 1e6;
constexpr double repetition_hz = 1000;

/// Five bursts, a stretch of which is missing.
ChannelHistory some_samples() {
    ChannelHistory history;
    const Bursts bursts(fs, repetition_hz);
    for (std::uint64_t frame_number = 0; frame_number < 50; ++frame_number) {
        if (frame_number == 23) {
            continue;
        }
        ReceivedFrame frame;
        frame.header.sample = 100 * frame_number;
        frame.header.n = 100;
        frame.header.channels = 1;
        frame.header.fs = fs;
        frame.header.burst = frame_number / 10;
        frame.header.burst_sample = 100 * (frame_number % 10);
        for (int i = 0; i < 100; ++i) {
            frame.values.push_back(
                static_cast<float>(std::sin(0.1 * (100.0 * static_cast<double>(frame_number) + i))));
        }
        history.take(frame, 1, repetition_hz, 0.01 * static_cast<double>(frame_number));
    }
    return history;
}

void claim_picture(const std::string& bytes, const ViewRequest& request) {
    claim(bytes.size() >= sizeof(PictureHead), "a picture has a head");
    PictureHead head;
    std::memcpy(&head, bytes.data(), sizeof(head));
    const bool each = (head.flags & PictureFlag::each_sample) != 0;
    claim(head.columns >= 1 && head.columns <= 2 * request.columns + 1,
          "a picture is no wider than was asked for");
    claim(head.rows == 1 + request.beside.size(), "a picture has a row for each channel");
    claim(bytes.size() == sizeof(head) + std::size_t{head.rows} * head.columns * (each ? 4 : 8),
          "a picture's rows fill it");
}

}  // namespace

}  // namespace hertzline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline::scope;
    using namespace hertzline::stream;
    namespace fuzz = hertzline::fuzz;
    static const ChannelHistory history = fuzz::some_samples();
    constexpr int most = 8;
    View view;
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    double now_s = 0.5;
    for (int i = 0; i < most && !rest.empty(); ++i, now_s += 0.1) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        const std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        try {
            const auto request = view_request(hertzline::json_from_outside(line));
            if (!request) {
                fuzz::claim_message(request.error(), fuzz::longest_message);
                continue;
            }
            view.ask(*request);
        } catch (const std::runtime_error& error) {
            fuzz::claim_message(error.what(), fuzz::longest_message);
            continue;
        }
        const std::vector<const ChannelHistory*> beside(view.request().beside.size(), &history);
        if (const auto picture = view.picture(history, beside, now_s)) {
            fuzz::claim_picture(*picture, view.request());
        }
    }
    return 0;
}
