#include "studies/sweep/survey.hpp"

#include <algorithm>

#include "studies/sweep/point_run.hpp"

namespace hertzline::studies {

SweepSurvey survey_of(const SweepPlan& plan, TapSet measured) {
    PointDemand largest;
    largest.measured = measured;
    SweepSurvey survey;
    for (std::int64_t point = 0; point < plan.size(); ++point) {
        const Scene scene = plan.scene(point);
        if (const std::string refusal = scene_refusal(scene); !refusal.empty()) {
            if (survey.refused++ == 0) {
                survey.first_refused = plan.name(point) + ": " + refusal;
            }
            continue;
        }
        survey.taps |= taps_of(scene.end);
        survey.modal = survey.modal || provides(scene.end, Requires::modal_plate);
        survey.rows = std::max(survey.rows, measures::rows_of_run(scene));
        survey.memory_bytes = std::max(survey.memory_bytes, point_memory_bytes(scene, largest));
    }
    return survey;
}

}  // namespace hertzline::studies
