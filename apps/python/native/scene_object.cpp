#include "apps/python/native/scene_object.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "apps/python/native/interruptible.hpp"
#include "apps/python/native/module.hpp"
#include "apps/python/native/python_values.hpp"
#include "core/scene/json.hpp"
#include "core/scene/scene_json.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/simulation.hpp"
#include "measures/run.hpp"
#include "measures/scene_report.hpp"

namespace hertzline::python {

namespace {

std::shared_ptr<SceneObject> parse(const std::string& text, const std::string& origin,
                                   const std::vector<std::string>& settings) {
    auto parsed = parse_scene(text, printable(origin), settings);
    if (!parsed) {
        throw py::value_error(fault_text(std::move(parsed.error())));
    }
    return std::make_shared<SceneObject>(*std::move(parsed));
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
        std::ranges::move(measures::contact_warnings(scene, peaks), std::back_inserter(warnings));
    });
    Json json = measures::report_json(report);
    json["scene_hash"] = scene_hash(scene);
    json["warnings"] = std::move(warnings);
    return python_object(json);
}

}  // namespace

std::shared_ptr<const Resolution> SceneObject::resolved() {
    if (!resolved_) {
        require_memory("simulating " + origin(), Simulation::memory_bytes(scene(), {}));
        std::optional<Resolution> found;
        interruptible([&](const std::atomic<bool>& stop) { found = hertzline::resolve(scene(), &stop); });
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

void add_scene(py::module_& module) {
    py::class_<SceneObject, std::shared_ptr<SceneObject>>(module, "Scene")
        .def_property_readonly("origin", &SceneObject::origin)
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
    module.def(
        "unknown_scene", [](const std::string& name) { return unknown_scene(name).message(); },
        py::arg("name"));
    module.def("materials", [] {
        py::list materials;
        for (const BuiltInMaterial& material : built_in_materials()) {
            materials.append(python_object(material_json(material)));
        }
        return materials;
    });
    module.def("shipped_scenes", [] {
        py::list scenes;
        for (const ShippedScene& scene : shipped_scenes()) {
            scenes.append(py::make_tuple(std::string(scene.name), std::string(scene.description),
                                         std::string(scene.text)));
        }
        return scenes;
    });
}

}  // namespace hertzline::python
