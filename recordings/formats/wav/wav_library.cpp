#include "recordings/formats/wav/wav_library.hpp"

#include "recordings/files/shared_library.hpp"

namespace hertzline::recordings {

void load_sndfile() {
    static const SharedLibrary loaded = [] {
        SharedLibrary library(HERTZLINE_SNDFILE_LIBRARY);
#define HERTZLINE_LOAD(name) library.find(name, #name);
        HERTZLINE_SNDFILE_FUNCTIONS(HERTZLINE_LOAD)
#undef HERTZLINE_LOAD
        return library;
    }();
    (void)loaded;
}

}  // namespace hertzline::recordings
