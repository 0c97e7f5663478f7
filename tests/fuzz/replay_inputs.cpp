// Stands in for libFuzzer in the ordinary tests: feeds every file of the given folders to the fuzz function.

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int count, char** folders) {
    namespace fs = std::filesystem;
    int inputs = 0;
    for (int i = 1; i < count; ++i) {
        for (const fs::directory_entry& file : fs::directory_iterator(folders[i])) {
            std::ifstream in(file.path(), std::ios::binary);
            const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
            try {
                LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
            } catch (const std::exception& error) {
                std::fprintf(stderr, "%s: %s\n", file.path().c_str(), error.what());
                return 1;
            }
            ++inputs;
        }
    }
    std::printf("%d inputs\n", inputs);
    return inputs > 0 ? 0 : 1;
}
