// Answers of a child process that reads a recording, which may have taken over the process.

#include <cstdint>
#include <span>

#include "recordings/isolated_reader.hpp"
#include "tests/fuzz/recording_claims.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hertzline;
    using recordings::Answers;
    using recordings::ChildProcess;
    fuzz::claim_recording_or_fault("x.h5", [=](const std::filesystem::path& path) {
        const auto say = [=](Answers& answers) { answers.write(std::as_bytes(std::span(data, size))); };
        return recordings::open_isolated_reader(
            path, std::make_unique<ChildProcess>(
                      say, recordings::ChildLimits{.silence = std::chrono::seconds(10)}));
    });
    return 0;
}
