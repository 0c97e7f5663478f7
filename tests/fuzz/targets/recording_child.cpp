// What a child process says that reads a recording: it may have been taken over by what it reads.

#include <cstdint>
#include <span>

#include "stream/recordings/isolated_reader.hpp"
#include "tests/fuzz/recording_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    using stream::Answers;
    using stream::ChildProcess;
    fuzz::claim_recording_or_fault("x.h5", [=](const std::filesystem::path& path) {
        const auto say = [=](Answers& answers) { answers.write(std::as_bytes(std::span(data, size))); };
        return stream::open_isolated_reader(
            path,
            std::make_unique<ChildProcess>(say, stream::ChildLimits{.silence = std::chrono::seconds(10)}));
    });
    return 0;
}
