#include "tests/support/random_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/hertz.hpp"
#include "core/numerics.hpp"
#include "core/scene_fields.hpp"
#include "core/scene_words.hpp"
#include "core/simulation.hpp"
#include "core/stability.hpp"

namespace hertzline::test {

namespace {

/// Numbers that are the same everywhere (the standard's distributions are not): S. Vigna's splitmix64.
class Draw {
public:
    explicit Draw(std::uint64_t seed) : state_(seed) {}

    double between(double least, double most) {
        return least + (most - least) * static_cast<double>(bits() >> 11U) * 0x1p-53;
    }
    /// Evenly spread over the orders of magnitude.
    double magnitude(double least, double most) { return std::exp(between(std::log(least), std::log(most))); }
    std::int64_t whole(std::int64_t least, std::int64_t most) {
        return least + static_cast<std::int64_t>(bits() % static_cast<std::uint64_t>(most - least + 1));
    }
    bool one_in(std::uint64_t n) { return bits() % n == 0; }
    double zero_or(double value) { return one_in(4) ? 0 : value; }
    template <class Value, std::size_t n>
    Value any(const std::array<Value, n>& values) {
        return values[bits() % n];
    }

private:
    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    std::uint64_t state_;
};

/// One of the built-in solids, or one of the scene's own.
std::string some_solid(Draw& draw, Scene& scene) {
    static const std::array<std::string, 6> built_in{"aluminium", "pyrex",           "vitreous_carbon",
                                                     "acrylic",   "silicone_rubber", "steel"};
    if (!draw.one_in(4)) {
        return draw.any(built_in);
    }
    const std::string name = "solid_" + std::to_string(scene.materials.size());
    scene.materials[name] =
        Solid{draw.magnitude(1e6, 1e12), draw.between(-0.5, 0.499), draw.magnitude(100, 2e4)};
    return name;
}

void draw_drive(Draw& draw, Scene& scene) {
    Drive& drive = scene.drive;
    drive.material = some_solid(draw, scene);
    drive.frequency_hz = draw.magnitude(1e3, 1e6);
    drive.cycles =
        draw.one_in(2) ? draw.magnitude(0.05, 30) : draw.any(std::array{0.25, 1.0, 3.0, 5.5, 25.0});
    drive.amplitude_m = draw.one_in(10) ? 0 : draw.magnitude(1e-12, 1e-4);
    drive.envelope = draw.any(choices<Envelope>);
    drive.taper = draw.any(std::array{0.0, 1e-3, 0.2, 0.7, 1.0});
    drive.repetition_hz = draw.zero_or(drive.frequency_hz / drive.cycles * draw.between(0.05, 1));
}

void draw_chain_and_end(Draw& draw, Scene& scene) {
    Spheres& chain = scene.chain;
    chain.material = some_solid(draw, scene);
    chain.spheres = draw.whole(1, 40);
    chain.diameter_m = draw.magnitude(0.1e-3, 10e-3);
    chain.damping_kg_per_s = draw.zero_or(draw.magnitude(1e-4, 1e2));
    chain.preload_n = draw.zero_or(draw.magnitude(1e-6, 1e2));
    chain.tension = draw.any(choices<Tension>);
    End& end = scene.end;
    end.kind = draw.any(choices<EndKind>);
    end.material = some_solid(draw, scene);
    end.radius_m = draw.magnitude(1e-3, 20e-3);
    end.thickness_m = draw.magnitude(0.05e-3, 10e-3);
    if (draw.one_in(2)) {
        end.stiffness_n_per_m = draw.one_in(8) ? 0 : draw.magnitude(1e2, 1e10);
    }
    end.preload = draw.any(choices<PlatePreload>);
}

/// Puts some of the numbers of a scene at the ends of what validate() allows.
struct ToTheEnds {
    Draw& draw;

    void operator()(std::string_view key, double& value, const fields::Range& range) const {
        if (!key.starts_with("output") && draw.one_in(6)) {
            value = draw.one_in(2) ? range.least : range.most;
        }
    }
    void operator()(std::string_view key, std::optional<double>& value, const fields::Range& range) const {
        if (!key.starts_with("numerics") && value) {
            (*this)(key, *value, range);
        }
    }
    template <class Member, class Allowed>
    void operator()(std::string_view, Member&, const Allowed&) const {}
};

void draw_extremes(Draw& draw, Scene& scene) {
    fields::visit_scene(scene, ToTheEnds{draw});
    const double most_bursts = scene.drive.frequency_hz / scene.drive.cycles;
    scene.drive.repetition_hz = std::min(scene.drive.repetition_hz, most_bursts);
}

/// From steps much shorter than needed to ones beyond the stability limit, and samples on their grid or off
/// it.
void draw_numerics(Draw& draw, Scene& scene) {
    if (!draw.one_in(16)) {
        scene.numerics.integrator = draw.any(choices<Integrator>);
    }
    const Chain chain(scene);
    const double stable = largest_stable_step(chain, expected_overlaps(chain, scene.drive),
                                              scene.numerics.integrator.value_or(Integrator::taylor8));
    const double longest = std::min({stable, 0.2 / scene.drive.frequency_hz, 1.0});
    const double step = std::clamp(longest * draw.magnitude(3e-3, 3), 1e-12, 1.0);
    if (draw.one_in(16) || !scene.numerics.integrator) {
        scene.numerics.accuracy = draw.magnitude(1e-9, 0.1);
    } else {
        scene.numerics.step_s = step;
    }
    const double steps_per_sample = draw.any(std::array{1.0, 4.0, 3.3, 0.7, 0.1, 20.0});
    scene.output.sample_rate_hz = std::min(1 / (step * steps_per_sample), 1e12);
    scene.output.duration_s = std::clamp(step * draw.magnitude(30, 3000), 1e-12, 1e6);
}

constexpr Wish all{.outputs = true, .chain_velocities = true, .chain_displacements = true};

bool finite(const Samples& block) {
    const auto fine = [&](const std::vector<double>& values, std::size_t width) {
        return std::all_of(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(block.count * width),
                           [](double v) { return std::isfinite(v); });
    };
    return fine(block.v_last, 1) && fine(block.v_plate, block.v_plate.empty() ? 0 : 1) &&
           fine(block.v_out, 1) && fine(block.chain_v, block.spheres) && fine(block.chain_x, block.spheres);
}

/// Steps that a run calls for: by the rates of what moves in it, by its contact events, and those asked for.
double steps_called_for(const Scene& scene, Simulation& simulation) {
    const Chain& chain = simulation.chain();
    const double rates = fastest_frequency(chain, simulation.state().peak_overlap) +
                         4 * (chain.damping * chain.inv_mass).maxCoeff() +
                         2 * std::numbers::pi * scene.drive.frequency_hz;
    const double bursts = scene.drive.repetition_hz * simulation.time_s();
    return 10 + simulation.time_s() * (rates + 1 / simulation.step_s()) + 4 * bursts +
           static_cast<double>(simulation.contact_events());
}

bool names(const std::string& message, const std::string& what) {
    return message.find(what) != std::string::npos;
}

void judge_stop(Trial& trial, std::size_t samples_in_block) {
    trial.outcome = Outcome::stopped;
    if (samples_in_block != 0) {
        trial.findings.emplace_back("the block in which it stopped is not empty");
    }
    const bool says = (names(trial.message, "step") || names(trial.message, "piece")) &&
                      names(trial.message, "t = ") && names(trial.message, "contact ");
    if (!says || names(trial.message, "nan") || names(trial.message, "inf")) {
        trial.findings.push_back("it stopped without step, time and contact: " + trial.message);
    }
}

Trial run(const Scene& scene) {
    constexpr double most_crowded = 40;
    constexpr std::size_t block = 64;
    Trial trial;
    trial.integrator = *scene.numerics.integrator;
    Simulation simulation(scene, all);
    Samples part(simulation.chain(), block, all);
    const double samples = std::clamp(scene.output.duration_s * scene.output.sample_rate_hz, 1.0, 20e3);
    double moved = 0;
    double work = 0;
    while (static_cast<double>(simulation.next_sample()) < samples) {
        const Status status = simulation.advance(part, block, all);
        if (!finite(part)) {
            trial.findings.emplace_back("a sample is not finite");
            break;
        }
        trial.steps = simulation.steps();
        if (status != Status::running) {
            trial.message = simulation.failure();
            judge_stop(trial, part.count);
            break;
        }
        moved += std::abs(simulation.ledger().work - work);
        work = simulation.ledger().work;
        trial.crowding = static_cast<double>(trial.steps) / steps_called_for(scene, simulation);
        if (trial.crowding > most_crowded) {
            trial.findings.emplace_back("pieces collapse");
            break;
        }
    }
    trial.simulated_s = simulation.time_s();
    const Ledger books = simulation.ledger();
    const double pressed =
        elastic_energy(simulation.chain().stiffness[0], simulation.state().peak_overlap[0]);
    const double turned_over = moved + books.lost + std::abs(books.at_start) + pressed;
    const double scale = std::max(std::abs(books.work), books.lost);
    trial.residual = turned_over > 0 ? simulation.energy_residual() * scale / turned_over : 0;
    if (trial.outcome == Outcome::ran && !std::isfinite(trial.residual)) {
        trial.findings.emplace_back("the ledger is not finite");
    }
    return trial;
}

/// Leapfrog does not book the work of a horn that jumps, and no method on a grid resolves one that goes up or
/// down within a step.
bool is_booked(const Scene& scene) {
    const Drive& drive = scene.drive;
    const Integrator integrator = *scene.numerics.integrator;
    const bool on_grid = integrator == Integrator::leapfrog || integrator == Integrator::chin4a;
    if (!on_grid || drive.envelope == Envelope::hann || drive.cycles == std::floor(drive.cycles)) {
        return true;
    }
    const bool jumps = drive.envelope == Envelope::rectangular || drive.taper == 0;
    const double rise_s = drive.taper / 2 * drive.cycles / drive.frequency_hz;
    return jumps ? integrator == Integrator::chin4a : rise_s > *scene.numerics.step_s;
}

}  // namespace

Scene random_scene(std::uint64_t seed) {
    Draw draw(seed);
    Scene scene;
    draw_drive(draw, scene);
    draw_chain_and_end(draw, scene);
    if (draw.one_in(8)) {
        draw_extremes(draw, scene);
    }
    draw_numerics(draw, scene);
    return scene;
}

Trial tried(const Scene& asked) {
    Scene scene = with_integrator(asked);
    Trial trial;
    trial.integrator = *scene.numerics.integrator;
    if (scene.numerics.step_s) {
        // resolved() refuses more, but only after a pilot
        constexpr double hopeless = 30;
        const Chain chain(scene);
        const double limit = largest_stable_step(chain, chain.static_overlap, trial.integrator);
        if (*scene.numerics.step_s > hopeless * limit) {
            trial.outcome = Outcome::refused;
            return trial;
        }
    } else {
        const Resolved result = resolved(asked);
        scene = result.scene;
        if (!result.faults.empty() || !(*scene.numerics.step_s > 0)) {
            trial.findings.emplace_back("no step is found for it");
            return trial;
        }
    }
    constexpr double steps_between_looks = 50;
    double& rate = scene.output.sample_rate_hz;
    rate = std::max(rate, 1 / (steps_between_looks * *scene.numerics.step_s));
    trial = run(scene);
    const double bound = trial.integrator == Integrator::leapfrog ? 1e-1 : 2e-2;
    if (trial.outcome != Outcome::ran || trial.residual <= bound || !is_booked(scene)) {
        return trial;
    }
    // a step too coarse for this scene, if what is missing falls with the step
    constexpr int most_refinements = 3;
    Trial fine = trial;
    for (int i = 0; i < most_refinements && !(fine.residual <= bound); ++i) {
        scene.numerics.step_s = std::max(*scene.numerics.step_s / 8, 1e-12);
        fine = run(scene);
    }
    if (!(fine.residual <= bound)) {
        trial.findings.push_back("energy is missing: " + std::to_string(trial.residual) +
                                 ", with a much shorter step " + std::to_string(fine.residual));
    }
    return trial;
}

}  // namespace hertzline::test
