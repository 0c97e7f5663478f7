#pragma once
// Chains on modal plates, and the solutions of an independent solver in tests/reference/modal.

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hertzline/samples.hpp"
#include "hertzline/scene.hpp"
#include "hertzline/simulation.hpp"

namespace hertzline::test {

inline Scene modal_scene() {
    Scene scene;
    scene.end.model = PlateModel::modal;
    return scene;
}

/// A scene that has a file there.
struct Wet {
    const char* file;  ///< without .csv
    Scene scene;
};

inline std::vector<Wet> wet_scenes() {
    Scene hann = modal_scene();
    hann.end.theory = PlateTheory::thin;
    Scene tukey = hann;
    tukey.drive.envelope = Envelope::tukey;
    Scene aluminium = hann;
    aluminium.end.material = "aluminium";
    aluminium.end.modes = 3;
    Scene dry = hann;
    dry.medium.load = FluidLoad::none;
    dry.end.loss_factor = 0.02;
    Scene thick = tukey;
    thick.end.theory = PlateTheory::thick;
    Scene laminate = tukey;
    laminate.end.theory = PlateTheory::thin;
    laminate.end.materials = {"aluminium", "acrylic"};
    laminate.end.thicknesses_m = {0.2e-3, 0.5e-3};
    Scene far = tukey;
    far.drive.cycles = 8;
    far.output.hydrophone_m = 0.2;
    Scene off_axis = tukey;
    off_axis.output.points_m = {{3e-3, 0, 10e-3}, {12e-3, 0, 10e-3}, {0, 0, 30e-3}, {2e-3, 1e-3, 2e-3}};
    return {{"wet_off_axis", off_axis},   {"far_hydrophone", far},     {"wet_vitreous_carbon", tukey},
            {"wet_thick", thick},         {"wet_laminate", laminate},  {"wet_vitreous_carbon_hann", hann},
            {"wet_aluminium", aluminium}, {"dry_vitreous_carbon", dry}};
}

/// Expects the samples of blocks of any size, with skipped stretches, to equal those of a single block.
inline void expect_parts_to_match(Simulation& parts, const Samples& expected, std::size_t rows, TapSet taps) {
    Samples block = parts.make_samples(700);
    std::size_t at = 0;
    for (std::size_t i = 0; at + 700 < rows; ++i) {
        if (i % 5 == 3) {
            ASSERT_EQ(parts.skip(311), Status::running);
            at += 311;
            continue;
        }
        const std::size_t count = 1 + (i * 97) % 700;
        ASSERT_EQ(parts.advance(block, count), Status::running);
        for (const Tap tap : taps) {
            const std::size_t channels = block.channels(tap);
            ASSERT_TRUE(std::ranges::equal(block[tap].first(count * channels),
                                           expected[tap].subspan(at * channels, count * channels)))
                << row_of(tap).name << ' ' << at;
        }
        at += count;
    }
}

using Columns = std::map<std::string, std::vector<double>>;

/// Reads a file's columns by the names in its head.
inline Columns read_columns(const std::string& file, const std::string& folder = "modal") {
    std::ifstream in(HERTZLINE_SOURCE_DIR "/tests/reference/" + folder + "/" + file + ".csv");
    std::string line;
    std::getline(in, line);
    std::vector<std::string> names;
    std::istringstream head(line);
    for (std::string name; std::getline(head, name, ',');) {
        names.push_back(name);
    }
    Columns columns;
    while (std::getline(in, line)) {
        std::istringstream cells(line);
        std::string cell;
        for (const std::string& name : names) {
            std::getline(cells, cell, ',');
            columns[name].push_back(std::stod(cell));
        }
    }
    return columns;
}

}  // namespace hertzline::test
