#pragma once
// The command line of a benchmark: [--json FILE] [WORD...]

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/scene/json.hpp"

namespace hertzline::bench {

struct Arguments {
    std::vector<std::string> words;  ///< arguments except --json
    std::string json_file;           ///< empty without --json

    Arguments(int argc, char** argv) : words(argv + 1, argv + argc) {
        if (words.size() >= 2 && words[0] == "--json") {
            json_file = words[1];
            words.erase(words.begin(), words.begin() + 2);
        }
    }

    /// Writes the results to the file of --json, if any.
    void save(const Json& results) const {
        if (!json_file.empty()) {
            std::ofstream file(json_file);
            if (!(file << results.dump(2) << '\n' << std::flush)) {
                throw std::runtime_error("cannot write " + json_file);
            }
        }
    }
};

}  // namespace hertzline::bench
