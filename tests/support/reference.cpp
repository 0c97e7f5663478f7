#include "tests/support/reference.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "hertzline/resolve.hpp"
#include "hertzline/scene_file.hpp"

namespace hertzline::test {

namespace {

const std::string folder = HERTZLINE_SOURCE_DIR "/tests/reference/";

Scene plate(const std::string& material) {
    Scene scene;
    scene.end.material = material;
    return scene;
}

Scene wall() {
    Scene scene = plate("steel");
    scene.end.kind = EndKind::wall;
    return scene;
}

template <class Change>
Scene changed(Scene scene, Change change) {
    change(scene);
    return scene;
}

}  // namespace

const std::vector<ReferenceScene>& reference_scenes() {
    static const std::vector<ReferenceScene> scenes{
        {"paper_vitreous_carbon", Scene{}},
        {"paper_aluminium", plate("aluminium")},
        {"paper_pyrex", plate("pyrex")},
        {"paper_acrylic", plate("acrylic")},
        {"paper_silicone_rubber", plate("silicone_rubber")},
        {"paper_wall", wall()},
        {"vitreous_carbon_tukey", changed(Scene{}, [](Scene& s) { s.drive.envelope = Envelope::tukey; })},
        {"vitreous_carbon_2mm", changed(Scene{}, [](Scene& s) { s.end.thickness_m = 2e-3; })},
        {"vitreous_carbon_as_printed",
         changed(Scene{}, [](Scene& s) { s.end.preload = PlatePreload::as_printed; })},
        {"free_end", changed(Scene{}, [](Scene& s) { s.end.kind = EndKind::free; })},
        {"sonic_vacuum_10", changed(wall(),
                                    [](Scene& s) {
                                        s.chain.spheres = 10;
                                        s.chain.preload_n = 0;
                                    })},
        {"small_amplitude_wall", changed(wall(), [](Scene& s) { s.drive.amplitude_m = 2e-9; })},
    };
    return scenes;
}

const Scene& reference_scene(const std::string& file) {
    for (const ReferenceScene& entry : reference_scenes()) {
        if (entry.file == file) {
            return entry.scene;
        }
    }
    throw std::out_of_range("no reference scene " + file);
}

Reference read_reference(const std::string& file) {
    std::ifstream in(folder + file + ".csv");
    std::string line;
    if (!std::getline(in, line)) {
        throw std::runtime_error("cannot read the reference " + file);
    }
    const bool has_plate = line.find("v_plate") != std::string::npos;
    Reference reference;
    while (std::getline(in, line)) {
        std::istringstream cells(line);
        std::string cell;
        const auto next = [&] {
            std::getline(cells, cell, ',');
            return std::stod(cell);
        };
        const double time_s = next();
        if (reference.v_last.size() == 1) {
            reference.interval_s = time_s;
        }
        reference.v_last.push_back(next());
        if (has_plate) {
            reference.v_plate.push_back(next());
            reference.v_out.push_back(next());
        }
    }
    return reference;
}

std::vector<std::string> random_references() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder + "accuracy")) {
        if (entry.path().extension() == ".toml") {
            names.push_back("accuracy/" + entry.path().stem().string());
        }
    }
    std::ranges::sort(names);
    return names;
}

Scene random_reference_scene(const std::string& file) {
    std::ifstream in(folder + file + ".toml");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto parsed = parse_scene(text, file);
    if (!in || !parsed) {
        throw std::runtime_error("cannot read the scene " + file);
    }
    return parsed->scene;
}

double relative_l2(std::span<const double> a, std::span<const double> b) {
    if (a.size() != b.size()) {
        throw std::runtime_error("records of different lengths are compared");
    }
    double difference = 0;
    double norm = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += (a[i] - b[i]) * (a[i] - b[i]);
        norm += b[i] * b[i];
    }
    return std::sqrt(difference / norm);
}

Comparison compare_with_reference(const Scene& scene, const Reference& reference) {
    const Resolution settled = resolve(scene);
    if (!settled.faults.empty()) {
        throw std::runtime_error(settled.faults.front().key + ": " + settled.faults.front().allowed);
    }
    Simulation simulation(settled.scene);
    Samples samples = simulation.make_samples(reference.v_last.size());
    if (simulation.advance(samples, samples.capacity()) != Status::running) {
        throw std::runtime_error(simulation.failure());
    }
    Comparison result;
    result.v_last = relative_l2(samples[Tap::v_last], reference.v_last);
    if (!reference.v_plate.empty()) {
        result.v_plate = relative_l2(samples[Tap::v_plate], reference.v_plate);
        result.v_out = relative_l2(samples[Tap::v_out], reference.v_out);
    }
    result.energy_residual = simulation.energy_residual();
    result.step_s = simulation.step_s();
    return result;
}

}  // namespace hertzline::test
