// A recording with the ending .h5, which a child process reads. That the HDF5 library crashes there is no finding: that it
// takes this process with it would be.

#include <cstdint>
#include <string_view>

#include <pthread.h>

#include "recordings/formats/hdf5/hdf5.hpp"
#include "tests/fuzz/memory_folder.hpp"
#include "tests/fuzz/recording_claims.hpp"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#include <sanitizer/common_interface_defs.h>
#define HERTZLINE_DEATH_CALLBACK
#endif
#endif

namespace {

using namespace hertzline;

std::unique_ptr<recordings::RecordingReader> open_briefly(const std::filesystem::path& path) {
    return recordings::open_hdf5_reader(path, {.memory_bytes = 1024.0 * 1024 * 1024,
                                               .processor = std::chrono::seconds(1),
                                               .silence = std::chrono::seconds(10)});
}

/// libFuzzer would save the input of a child that a sanitizer ends.
[[maybe_unused]] void forget_the_fuzzer() {
#ifdef HERTZLINE_DEATH_CALLBACK
    __sanitizer_set_death_callback(nullptr);
#endif
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::MemoryFolder folder;
    [[maybe_unused]] static const int once = ::pthread_atfork(nullptr, nullptr, forget_the_fuzzer);
    folder.hold("x.h5", {reinterpret_cast<const char*>(data), size});
    fuzz::claim_recording_or_fault(folder.file("x.h5"), open_briefly);
    return 0;
}
