// Receives the frames of v_out until the stream ends, and prints their peak and whether any are missing.
//
//     listen [ENDPOINT]        tcp://127.0.0.1:5573 unless told otherwise
//
// Any publisher of hertzline will do: the example publish, or `hertzline stream paper-stream`.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include <hertzline/hertzline.hpp>

namespace {

void listen(const std::string& endpoint) {
    hertzline::Listener listener(endpoint, {.taps = hertzline::Tap::v_out, .timeout_s = 10});
    float peak = 0;
    while (!listener.ended()) {
        if (const auto* frame = listener.receive(std::chrono::milliseconds(100))) {
            for (const float v : frame->values) {
                peak = std::max(peak, std::abs(v));
            }
        }
    }
    std::cout << listener.text() << "; peak " << peak << " m/s\n";
    if (!listener.complete()) {
        throw std::runtime_error("the stream is incomplete");
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        listen(argc > 1 ? argv[1] : "tcp://127.0.0.1:5573");
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
