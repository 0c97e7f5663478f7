// Publishes the stream of a scene from a program of its own.
//
//     publish [ENDPOINT]       tcp://127.0.0.1:5573 unless told otherwise
//
// Waits for a subscriber, sends a tenth of a second of signal in step with the clock, and ends.

#include <atomic>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>

#include <hertzline/hertzline.hpp>

namespace {

std::atomic<bool> stop = false;

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGINT, [](int) { stop = true; });
    try {
        hertzline::Scene scene;
        scene.drive.repetition_hz = 1000;  // a burst each millisecond
        const auto summary = hertzline::publish(
            hertzline::resolve(scene),
            {.endpoint = argc > 1 ? argv[1] : "tcp://127.0.0.1:5573",
             .duration_s = 0.1,
             .wait_for_subscriber = true,
             .stop = &stop,
             .bound =
                 [](const std::string& endpoint) { std::cout << "publishing at " << endpoint << std::endl; },
             .warn = [](const std::string& text) { std::cerr << text << '\n'; }});
        std::cout << summary["frames"] << " frames, " << summary["late_frames"] << " of them late\n";
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
