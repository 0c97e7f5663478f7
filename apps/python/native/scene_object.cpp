#include "apps/python/native/scene_object.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "core/model/drive.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "measures/measuring.hpp"
#include "measures/scene_report.hpp"
#include "recordings/drive_record.hpp"
#include "recordings/named_scene.hpp"

namespace hertzline::python {

namespace {

/// Reads a scene and, where it names one, the record of its drive. @param parse_with takes a function for warnings
template <class Parse>
std::shared_ptr<SceneObject> object_of(const Parse& parse_with) {
    std::vector<std::string> warnings;
    auto parsed = parse_with([&](const std::string& warning) { warnings.push_back(warning); });
    warn_all(warnings);
    if (!parsed) {
        throw py::value_error(fault_text(std::move(parsed.error())));
    }
    return std::make_shared<SceneObject>(*std::move(parsed));
}

using Parsed = tl::expected<ParsedScene, std::vector<Fault>>;

std::shared_ptr<SceneObject> parse(const std::string& text, const std::string& origin,
                                   std::vector<std::string> settings) {
    const auto sets = [&](std::string_view key) {
        return std::ranges::any_of(settings, [&](const std::string& one) { return one.starts_with(key); });
    };
    Drive before;
    if (sets("drive.file=")) {
        if (const auto base = parse_scene(text, origin, {})) {
            before = base->scene.drive;
        }
    }
    const bool holds_record = !before.samples.empty();
    if (holds_record && !sets("drive.file=null")) {  // another one takes its place
        for (const char* of_record :
             {"drive.samples=", "drive.sample_rate_hz=", "drive.quantity=", "drive.scale="}) {
            if (!sets(of_record)) {
                settings.push_back(std::string(of_record) + "null");
            }
        }
    }
    return object_of([&](const auto& warn) -> Parsed {
        Parsed parsed = parse_scene(text, origin, settings);
        if (!parsed || (!sets("drive.samples=") && !sets("drive.file="))) {
            return parsed;
        }
        const bool for_a_record =
            before.kind == DriveKind::file && !holds_record && before.frequency_hz != Drive{}.frequency_hz;
        if (!sets("drive.frequency_hz=") && !for_a_record) {
            parsed->places.erase("drive.frequency_hz");  // of the drive before
        }
        if (auto fault = read_drive(*parsed, warn)) {
            return tl::unexpected(std::vector{*std::move(fault)});
        }
        return parsed;
    });
}

std::shared_ptr<SceneObject> read(const std::string& name, const std::vector<std::string>& settings) {
    return object_of([&](const auto& warn) { return recordings::parse_named_scene(name, settings, warn); });
}

py::object check(SceneObject& object) {
    const std::shared_ptr<const Resolution> resolved = object.resolved();
    const Scene& scene = resolved->scene;
    std::vector<measures::ReportRow> report;
    std::vector<std::string> warnings = measures::scene_warnings(*resolved);
    interruptible([&](const std::atomic<bool>&) {
        const auto peaks =
            measures::peak_overlaps(scene, std::min(scene.output.duration_s, measures::first_burst_s(scene)));
        report = measures::scene_report(*resolved, peaks);
        std::ranges::move(measures::check_warnings(scene, peaks), std::back_inserter(warnings));
    });
    Json json = measures::report_json(report);
    json["scene_hash"] = scene_hash(scene);
    json["warnings"] = std::move(warnings);
    return python_object(json);
}

}  // namespace

std::shared_ptr<const Resolution> SceneObject::resolved() {
    if (!resolved_) {
        require_memory("simulating " + printable_whole(origin()), Simulation::memory_bytes(scene(), {}));
        std::optional<Resolution> found;
        interruptible([&](const std::atomic<bool>& stop) {
            const auto run_s =
                awaits_samples(scene().drive) ? std::nullopt : std::optional(scene().output.duration_s);
            found = hertzline::resolve(scene(), run_s, &stop);
        });
        if (!found->faults.empty()) {
            for (Fault& fault : found->faults) {
                fault = parsed_.placed(fault);
            }
            throw py::value_error(fault_text(found->faults));
        }
        resolved_ = std::make_shared<const Resolution>(*std::move(found));
    }
    return resolved_;
}

std::shared_ptr<const Resolution> SceneObject::resolved_to_run() {
    if (const auto fault = awaited_samples_fault(scene().drive)) {
        throw py::value_error(fault_text(std::vector{parsed_.placed(*fault)}));
    }
    return resolved();
}

void add_scene(py::module_& module) {
    py::class_<SceneObject, std::shared_ptr<SceneObject>>(module, "Scene")
        .def_property_readonly("origin", [](const SceneObject& object) { return text_of(object.origin()); })
        .def("toml", [](const SceneObject& object) { return to_toml(object.scene()); })
        .def("hash", [](const SceneObject& object) { return scene_hash(object.scene()); })
        .def("values",
             [](const SceneObject& object) {
                 Json values = scene_json(object.scene());
                 for (const SceneKey& key : scene_keys()) {
                     values[key.section()].emplace(std::string(key.key),
                                                   nullptr);  // lists that are not given
                 }
                 return python_object(values);
             })
        .def("resolved",
             [](SceneObject& object) {
                 return std::make_shared<SceneObject>(
                     ParsedScene{object.resolved()->scene, object.origin(), {}});
             })
        .def("check", &check);
    module.def("parse", &parse, py::arg("text"), py::arg("origin"), py::arg("settings"));
    module.def("read", &read, py::arg("name"), py::arg("settings"));
    module.def("materials", [] {
        py::list materials;
        for (const BuiltInMaterial& material : built_in_materials()) {
            materials.append(python_object(material_json(material)));
        }
        return materials;
    });
    module.def("shipped_scenes", [] {
        py::dict scenes;
        for (const ShippedScene& scene : shipped_scenes()) {
            scenes[py::str(scene.name)] = std::string(scene.description);
        }
        return scenes;
    });
}

}  // namespace hertzline::python
