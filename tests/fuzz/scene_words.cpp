// Prints the sections, keys and words of scenes as a fuzzer's dictionary has them.

#include <iostream>
#include <set>
#include <string>

#include "core/scene/scene_key.hpp"

int main() {
    using namespace hertzline;
    Scene scene;
    scene.materials = {{"solid", Solid{}}, {"fluid", Fluid{}}};
    std::set<std::string> lines;
    for (const SceneKey& key : keys_of(scene)) {
        lines.insert({"[" + key.section() + "]", key.section() + ".", std::string(key.key)});
        if (key.is_list()) {
            lines.insert({key.name + "[1]=", key.name + "=[", std::string(key.key) + " = ["});
        }
        for (const std::string& word : key.words) {
            lines.insert(R"(\")" + word + R"(\")");
        }
    }
    for (const std::string& line : lines) {
        std::cout << '"' << line << "\"\n";
    }
}
