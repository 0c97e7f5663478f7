// Publishes the stream of a scene from a program of its own: what `hertzline stream` does, without its options.
//
//     publish [ENDPOINT]       tcp://127.0.0.1:5573 unless told otherwise
//
// Waits for a subscriber, sends a tenth of a second of signal in step with the clock, and ends.

#include <atomic>
#include <csignal>
#include <cstdint>
#include <exception>
#include <iostream>
#include <string>

#include <hertzline/hertzline.hpp>
#include <hertzline/stream.hpp>

namespace {

std::atomic<bool> stop = false;

void publish(const std::string& endpoint) {
    hertzline::Scene scene;
    scene.drive.repetition_hz = 1000;  // a burst each millisecond
    scene = hertzline::resolve(scene).scene;

    // source -> pipeline -> publisher: the pipeline simulates ahead of the clock in a thread of its own and sends each frame
    // when it is due.
    hertzline::stream::SimulationSource source(scene, {});  // computes what somebody subscribes to
    hertzline::stream::Publisher publisher(endpoint);
    hertzline::stream::StreamOptions options;
    options.about = {{"title", "example"}};  // subscribers find it in the meta message
    options.start = hertzline::stream::StreamStart::with_first_subscriber;
    options.samples = static_cast<std::int64_t>(0.1 * scene.output.sample_rate_hz);
    hertzline::stream::Pipeline pipeline(options, source, publisher, nullptr);

    const hertzline::stream::StreamEvents events{
        .progress = [](const hertzline::stream::StreamMeters&) {},  // a place for a progress line
        .warn = [](const std::string& text) { std::cerr << text << '\n'; },
        // the end message, which tells listeners how much there was
        .summary =
            [&](const hertzline::stream::StreamMeters& meters) {
                return hertzline::json_text({{"run", pipeline.options().run},
                                             {"samples", meters.samples},
                                             {"dropped_frames", meters.dropped_frames}});
            },
    };
    std::cout << "publishing at " << publisher.endpoint() << std::endl;
    const hertzline::stream::StreamMeters meters = pipeline.run(stop, events);
    std::cout << meters.frames << " frames, " << meters.late_frames << " of them late\n";
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGINT, [](int) { stop = true; });
    try {
        publish(argc > 1 ? argv[1] : "tcp://127.0.0.1:5573");
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
