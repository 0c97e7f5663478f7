#pragma once
// The table of a scene's keys: a row each, which holds all that the program knows of the key. Scene files, --set, JSON, bounds, live
// changes, sweeps, hashes, warnings, the schema and the tables of scenes/README.md loop over it (scene_key.hpp).
//
// The structured bindings name every member of a section, so a member without a row does not compile.
//
// The bounds are generous. They are there so that no product of allowed numbers overflows, and so that sample and step counts
// (duration times 1e12 at most) fit 63 bits; a device within them need not make sense.

#include "core/scene/scene_key.hpp"
#include "hertzline/scene.hpp"

namespace hertzline::table {

inline constexpr Need plate{"end.kind", {"plate"}};
inline constexpr Need body{"end.kind", {"plate", "wall"}};
inline constexpr Need modal{"end.model", {"modal"}};
inline constexpr Need horn{"drive.kind", {"tone", "file", "live"}};
inline constexpr Need bursts{"drive.kind", {"tone", "file"}};
inline constexpr Need tone{"drive.kind", {"tone", "live"}};
inline constexpr Need samples_of{"drive.kind", {"file", "live"}};
inline constexpr Need live{"drive.kind", {"live"}};
inline constexpr Need resonator{"drive.horn", {"resonator"}};
inline constexpr Need tukey{"drive.envelope", {"tukey"}};
inline constexpr Need dashpot{"chain.damping_law", {"dashpot"}};
inline constexpr Need kuwabara_kono{"chain.damping_law", {"kuwabara_kono"}};
inline constexpr Need tsuji{"chain.damping_law", {"tsuji"}};
inline constexpr Hashed changed = Hashed::when_changed;
inline constexpr std::string_view chosen = "the program's choice";

/// Calls visit(section, member, row) for each key of a scene, in the order of its file.
template <class AnyScene, class Visit>
void visit_scene(AnyScene& scene, const Visit& visit) {
    {
        auto& [kind, material, frequency_hz, cycles, amplitude_m, envelope, taper, repetition_hz, sweep_to_hz,
               start_s, record, column, quantity, sample_rate_hz, scale, lowpass_hz, samples, endpoint,
               socket, on_underrun, horn_model, horn_frequency_hz, horn_quality, horn_mass_kg] = scene.drive;
        const auto row = [&](auto& member, const KeyRow& facts) { visit("drive", member, facts); };
        row(kind, {"kind",
                   {},
                   "a horn with tone bursts, one that moves [as a record does](#a-recorded-drive) or [as "
                   "samples come](#a-live-drive), or no horn",
                   {.hashed = changed}});
        row(material, {"material", {}, "of the horn", {.needs = horn}});
        row(frequency_hz, {"frequency_hz",
                           {1e-3, 1e9, "Hz"},
                           "of the tone; of samples, the line whose harmonics are measured"});
        row(cycles, {"cycles",
                     {1e-3, 1e9},
                     "periods of the tone in a burst; of a live drive, those for which the step is chosen",
                     {.needs = tone}});
        row(amplitude_m, {"amplitude_m",
                          {0, 1, "m"},
                          "largest displacement of the horn's tip; of a resonator, in the steady state; of a "
                          "live drive, the one to be expected",
                          {.needs = tone}});
        row(envelope, {"envelope", {}, "how the burst rises and falls", {.needs = tone}});
        row(taper, {"taper", {0, 1}, "fraction of a tukey burst spent rising and falling", {.needs = tukey}});
        row(repetition_hz, {"repetition_hz",
                            {0, 1e9, "Hz"},
                            "bursts, or records, a second; 0: a single one",
                            {.needs = bursts}});
        row(sweep_to_hz, {"sweep_to_hz",
                          {1e-3, 1e9, "Hz"},
                          "frequency at the burst's end, for a linear sweep (chirp)",
                          {.unset = "`frequency_hz`", .needs = tone, .hashed = changed}});
        row(start_s, {"start_s",
                      {0, 1e6, "s"},
                      "delay of the burst; of a live drive, its latency: a shorter one becomes the least, "
                      "which `check` prints",
                      {.needs = horn, .hashed = changed}});
        row(record, {"file",
                     {},
                     "the record of the horn's motion, beside the scene; its samples become `samples`",
                     {.needs = samples_of, .hashed = changed, .is_text = true}});
        row(column,
            {"column",
             {},
             "of the file: its name, or its number from 1 on; with the socket `sub`, the stream's name",
             {.unset = "the first",
              .needs = samples_of,
              .hashed = changed,
              .is_text = true,
              .reads_record = true}});
        row(quantity, {"quantity",
                       {},
                       "that was recorded",
                       {.unset = "by the column's unit, else a displacement",
                        .needs = samples_of,
                        .hashed = changed,
                        .reads_record = true}});
        row(sample_rate_hz, {"sample_rate_hz",
                             {1e-3, 1e12, "Hz"},
                             "of the samples",
                             {.unset = "the file's; of a live drive, that of the output",
                              .needs = samples_of,
                              .hashed = changed,
                              .reads_record = true}});
        row(scale, {"scale",
                    {-1e12, 1e12},
                    "m, or m/s, for each unit of the record, in place of the unit of its column; not 0",
                    {.unset = "by the column's unit, else 1", .needs = samples_of, .hashed = changed}});
        row(lowpass_hz,
            {"lowpass_hz",
             {1e-3, 1e9, "Hz"},
             "upper limit of the frequencies that are kept of the record, a third of its rate at most",
             {.unset = "a third of the rate, at most 1 MHz", .needs = samples_of, .hashed = changed}});
        row(samples, {"samples",
                      {-1e100, 1e100},
                      "the record",
                      {.needs = samples_of, .hashed = changed, .most_entries = max_drive_samples}});
        row(endpoint, {"endpoint",
                       {},
                       "where the samples come in: `pull` binds it, or connects where a sender has bound it; "
                       "`sub` connects; "
                       "`bind:` or `connect:` in front decides",
                       {.needs = live, .hashed = changed, .is_text = true}});
        row(socket, {"socket",
                     {},
                     "ZeroMQ's socket: `pull` holds its senders back, `sub` may lose messages",
                     {.needs = live, .hashed = changed}});
        row(on_underrun, {"on_underrun",
                          {},
                          "when samples come too late, the stream waits for them, or takes 0 in their place",
                          {.needs = live, .hashed = changed}});
        row(horn_model, {"horn",
                         {},
                         "whether the tip moves as prescribed, or as [a resonator on which the chain acts "
                         "back](../docs/model.md#a-horn-that-the-chain-acts-back-on)",
                         {.needs = horn, .hashed = changed}});
        row(horn_frequency_hz, {"horn_frequency_hz",
                                {1e-3, 1e9, "Hz"},
                                "of the resonator",
                                {.unset = "`frequency_hz`", .needs = resonator, .hashed = changed}});
        row(horn_quality,
            {"horn_quality", {0.5, 1e6}, "Q of the resonator", {.needs = resonator, .hashed = changed}});
        row(horn_mass_kg, {"horn_mass_kg",
                           {0, 1e6, "kg"},
                           "that moves with its tip; 0: the chain does not act back",
                           {.needs = resonator, .hashed = changed}});
    }
    {
        auto& [material, spheres, diameter_m, materials, diameters_m, taper, damping_kg_per_s, damping_law,
               damping_time_s, damping_alpha, preload_n, tension, gravity_m_per_s2, holder_time_s,
               impact_velocity_m_per_s, impact_spheres, tolerance, preload_tolerance, seed] = scene.chain;
        const auto row = [&](auto& member, const KeyRow& facts) { visit("chain", member, facts); };
        row(material, {"material", {}, "of the spheres"});
        row(spheres, {"spheres", {1, max_spheres}, "how many"});
        row(diameter_m, {"diameter_m", {1e-9, 10, "m"}, "of each sphere"});
        row(materials,
            {"materials",
             {},
             "of the spheres from the horn on, repeated along the chain",
             {.unset = "`[material]`", .most_entries = max_sphere_entries, .each = "chain.material"}});
        row(diameters_m,
            {"diameters_m",
             {1e-9, 10, "m"},
             "of the spheres, repeated along the chain",
             {.unset = "`[diameter_m]`", .most_entries = max_sphere_entries, .each = "chain.diameter_m"}});
        row(taper,
            {"taper",
             {-1, 1, "", Bounds::open},
             "each sphere is smaller than the one before by this fraction, on top of its entry in the lists",
             {.hashed = changed}});
        row(damping_kg_per_s, {"damping_kg_per_s",
                               {0, 1e9, "kg/s"},
                               R"(of each closed contact, with `"dashpot"`)",
                               {.needs = dashpot}});
        row(damping_law, {"damping_law",
                          {},
                          "[how closed contacts lose energy](../docs/model.md#3-contacts)",
                          {.hashed = changed}});
        row(damping_time_s, {"damping_time_s",
                             {0, 1, "s"},
                             R"(A of `"kuwabara_kono"`, which needs it)",
                             {.needs = kuwabara_kono}});
        row(damping_alpha,
            {"damping_alpha", {0, 10}, "\u03b1 of `\"tsuji\"`, which needs it", {.needs = tsuji}});
        row(preload_n, {"preload_n", {0, 1e9, "N"}, "static force that presses the chain together"});
        row(tension, {"tension", {}, "whether damping may pull just before a contact opens"});
        row(gravity_m_per_s2, {"gravity_m_per_s2",
                               {-1e4, 1e4, "m/s^2"},
                               "weight of the spheres, toward the end",
                               {.hashed = changed}});
        row(holder_time_s, {"holder_time_s",
                            {1e-9, 1e6, "s"},
                            "\u03c4 of the holder, which slows each sphere by v/\u03c4",
                            {.hashed = changed}});
        row(impact_velocity_m_per_s, {"impact_velocity_m_per_s",
                                      {-1e3, 1e3, "m/s"},
                                      "of the first spheres at the start",
                                      {.hashed = changed}});
        row(impact_spheres, {"impact_spheres",
                             {1, max_spheres},
                             "how many start with it, `spheres` at most",
                             {.hashed = changed}});
        row(tolerance, {"tolerance",
                        {0, 0.5},
                        "largest relative deviation of each diameter, drawn at random",
                        {.hashed = changed}});
        row(preload_tolerance,
            {"preload_tolerance", {0, 0.9}, "the same of the preload", {.hashed = changed}});
        row(seed, {"seed",
                   {0, 1'000'000'000},
                   "of the random draws of the tolerances, the same on every machine",
                   {.hashed = changed}});
    }
    {
        auto& [kind, material, radius_m, thickness_m, stiffness_n_per_m, preload, model, modes, loss_factor,
               theory, materials, thicknesses_m, loss_factors] = scene.end;
        const auto row = [&](auto& member, const KeyRow& facts) { visit("end", member, facts); };
        row(kind, {"kind", {}, "a clamped disc, an immovable wall, only the preload"});
        row(material, {"material", {}, "of the disc or wall", {.needs = body}});
        row(radius_m, {"radius_m", {1e-9, 10, "m"}, "of the disc", {.needs = plate}});
        row(thickness_m, {"thickness_m", {1e-9, 10, "m"}, "of the disc", {.needs = plate}});
        row(stiffness_n_per_m, {"stiffness_n_per_m",
                                {0, 1e15, "N/m"},
                                "of the disc",
                                {.unset = "from plate theory", .needs = plate}});
        row(preload,
            {"preload", {}, "whether the disc starts in balance with the preload", {.needs = plate}});
        row(model, {"model",
                    {},
                    "the paper's mass on a spring, or [modes in a "
                    "fluid](../docs/model.md#10-the-plate-with-its-modes-in-a-fluid)",
                    {.hashed = changed}});
        row(modes, {"modes", {1, 6}, "of a modal plate", {.needs = modal, .hashed = changed}});
        row(loss_factor, {"loss_factor",
                          {1e-6, 1},
                          "of a modal plate's material: an assumption",
                          {.needs = modal, .hashed = changed}});
        row(theory, {"theory",
                     {},
                     "of a modal plate: Kirchhoff's, or Mindlin's with shear and rotary inertia",
                     {.needs = modal, .hashed = Hashed::when_in_effect}});
        row(materials,
            {"materials",
             {},
             "of the disc's [layers](#layers), from the sphere to the medium",
             {.unset = "`[material]`", .needs = plate, .most_entries = max_layers, .each = "end.material"}});
        row(thicknesses_m, {"thicknesses_m",
                            {1e-9, 10, "m"},
                            "of the layers",
                            {.unset = "`[thickness_m]`",
                             .needs = plate,
                             .most_entries = max_layers,
                             .each = "end.thickness_m"}});
        row(loss_factors, {"loss_factors",
                           {1e-6, 1},
                           "of the layers of a modal plate",
                           {.unset = "`loss_factor` for each",
                            .needs = modal,
                            .most_entries = max_layers,
                            .each = "end.loss_factor"}});
    }
    {
        auto& [material, load] = scene.medium;
        const auto row = [&](auto& member, const KeyRow& facts) { visit("medium", member, facts); };
        row(material,
            {"material", {}, "that the disc radiates into", {.needs = plate, .sort = MaterialSort::fluid}});
        row(load, {"load", {}, "effect on a modal plate", {.needs = modal, .hashed = changed}});
    }
    {
        auto& [x_m, y_m, delays_s, preloads_n, amplitudes_m, materials, diameters_m, focus_m, coupling] =
            scene.array;
        const auto row = [&](auto& member, const KeyRow& facts) { visit("array", member, facts); };
        row(x_m, {"x_m",
                  {-10, 10, "m"},
                  "where the discs of [several chains](#arrays) stand in one baffle",
                  {.unset = "one chain", .needs = modal, .most_entries = max_elements}});
        row(y_m, {"y_m", {-10, 10, "m"}, "the same", {.needs = modal, .most_entries = max_elements}});
        row(delays_s,
            {"delays_s",
             {0, 1, "s"},
             "of the elements' drives, added to `drive.start_s`; one entry for each element, or one for all",
             {.unset = "0", .needs = horn, .most_entries = max_elements}});
        row(preloads_n, {"preloads_n",
                         {0, 1e9, "N"},
                         "of the elements, in place of `chain.preload_n`",
                         {.unset = "`preload_n`", .most_entries = max_elements, .each = "chain.preload_n"}});
        row(amplitudes_m, {"amplitudes_m",
                           {0, 1, "m"},
                           "of the elements' drives, in place of `drive.amplitude_m`",
                           {.unset = "`amplitude_m`",
                            .needs = tone,
                            .most_entries = max_elements,
                            .each = "drive.amplitude_m"}});
        row(materials, {"materials",
                        {},
                        "of the elements' spheres, in place of `chain.material`",
                        {.unset = "`material`", .most_entries = max_elements, .each = "chain.material"}});
        row(diameters_m,
            {"diameters_m",
             {1e-9, 10, "m"},
             "of the elements' spheres, in place of `chain.diameter_m`",
             {.unset = "`diameter_m`", .most_entries = max_elements, .each = "chain.diameter_m"}});
        row(focus_m, {"focus_m",
                      {-10, 10, "m"},
                      "`[x, y, z]` of a point: delays are added so that the sound of all elements arrives "
                      "there together; `[]`: no focus",
                      {.needs = horn, .most_entries = 3}});
        row(coupling, {"coupling",
                       {},
                       "whether the discs feel each other through the fluid",
                       {.needs = modal, .hashed = changed}});
    }
    {
        auto& [integrator, step_s, accuracy, rest_tolerance, poles] = scene.numerics;
        const auto row = [&](auto& member, const KeyRow& facts) { visit("numerics", member, facts); };
        row(integrator, {"integrator", {}, "the method", {.unset = chosen}});
        row(step_s,
            {"step_s", {1e-15, 1, "s"}, "the step, or the longest piece of a series", {.unset = chosen}});
        row(accuracy, {"accuracy",
                       {1e-15, 0.1},
                       "wanted relative error of the last sphere and of the end, in their velocities",
                       {.unset = chosen}});
        row(rest_tolerance, {"rest_tolerance", {0, 0.01}, "motion below which a chain sleeps; 0: never"});
        row(poles, {"poles",
                    {16, 64},
                    "of a modal plate's response in its fluid",
                    {.unset = "by accuracy", .needs = modal}});
    }
    {
        auto& [sample_rate_hz, duration_s, frame_samples, hydrophone_m, points_m] = scene.output;
        const auto row = [&](auto& member, const KeyRow& facts) { visit("output", member, facts); };
        row(sample_rate_hz, {"sample_rate_hz", {1e-3, 1e12, "Hz"}, "samples a second"});
        row(duration_s,
            {"duration_s", {1e-12, 1e6, "s"}, "simulated by `run`; a stream goes on until stopped"});
        row(frame_samples, {"frame_samples", {1, 1'048'576}, "samples in each frame of a stream"});
        row(hydrophone_m, {"hydrophone_m",
                           {0, 10, "m"},
                           "its distance from a modal plate, on the axis",
                           {.needs = modal, .hashed = changed}});
        row(points_m, {"points_m",
                       {-10, 10, "m"},
                       "`[[x, y, z], ...]` of `p_points`, from the centre of a modal plate, z along the axis "
                       "into the medium",
                       {.needs = modal, .most_entries = max_points}});
    }
}

inline constexpr KeyRow density{"density_kg_per_m3", {1e-3, 1e6, "kg/m^3"}, "of a solid or a fluid"};

/// The same for a material of a scene, in the section [materials.NAME].
template <class AnyMaterial, class Visit>
void visit_material(AnyMaterial& material, std::string_view section, const Visit& visit) {
    const auto row = [&](auto& member, const KeyRow& facts) { visit(section, member, facts); };
    if (auto* solid = std::get_if<Solid>(&material)) {
        auto& [youngs_modulus_pa, poissons_ratio, density_kg_per_m3, yield_strength_pa,
               flexural_strength_pa] = *solid;
        row(youngs_modulus_pa, {"youngs_modulus_pa", {1, 1e15, "Pa"}, "of a solid"});
        row(poissons_ratio, {"poissons_ratio", {-1, 0.5, "", Bounds::open}, "of a solid"});
        row(density_kg_per_m3, density);
        row(yield_strength_pa, {"yield_strength_pa", {1, 1e15, "Pa"}, "of a solid", {.unset = "unknown"}});
        row(flexural_strength_pa, {"flexural_strength_pa",
                                   {1, 1e15, "Pa"},
                                   "of a solid that breaks before it yields",
                                   {.unset = "unknown"}});
    } else {
        auto& [density_kg_per_m3, sound_speed_m_per_s] = std::get<Fluid>(material);
        row(density_kg_per_m3, density);
        row(sound_speed_m_per_s, {"sound_speed_m_per_s", {1e-3, 1e6, "m/s"}, "of a fluid"});
    }
}

}  // namespace hertzline::table
