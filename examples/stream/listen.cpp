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
#include <vector>

#include <hertzline/stream.hpp>

namespace {

void listen(const std::string& endpoint) {
    hertzline::stream::Subscriber subscriber(endpoint);
    subscriber.subscribe("v_out/np");  // a JSON header, then the samples
    subscriber.subscribe("end");

    hertzline::stream::ContinuityCheck continuity;  // finds gaps: a slow subscriber loses frames
    std::vector<float> samples;
    float peak = 0;
    while (const hertzline::stream::Message* message = subscriber.receive(std::chrono::seconds(10))) {
        if (message->topic() == "end") {
            std::cout << continuity.text() << "; peak of v_out " << peak << " m/s\n";
            return;
        }
        if (message->parts() != 2) {
            continue;  // not a frame of ours
        }
        const auto frame = hertzline::stream::decode_header(message->text(0), message->bytes(1).size());
        if (!frame || !hertzline::recordings::decode_samples(message->bytes(1), samples)) {
            continue;  // damaged
        }
        continuity.take(*frame);
        for (const float v : samples) {
            peak = std::max(peak, std::abs(v));
        }
    }
    throw std::runtime_error("nothing arrived for ten seconds");
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
