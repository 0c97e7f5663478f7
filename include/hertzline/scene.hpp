#pragma once
// The request of a user, in SI units, with the paper's values as defaults. validate() finds its faults, and resolve()
// (hertzline/resolve.hpp) chooses the integrator and the step that it leaves open.

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hertzline/integrator.hpp"
#include "hertzline/materials.hpp"

namespace hertzline {

enum class DriveKind { tone, file, live, none };
enum class DriveQuantity { displacement, velocity };
/// ZeroMQ's socket that takes a live drive: one that holds its senders back, or one that may lose messages.
enum class DriveSocket { pull, sub };
/// When samples of a live drive come too late: the stream waits, or the horn's samples are 0.
enum class OnUnderrun { wait, zero };
/// How the chain acts back on the horn: not at all, or on a tip that is a mass on a spring.
enum class HornModel { prescribed, resonator };
enum class Envelope { hann, tukey, rectangular };
enum class DampingLaw { dashpot, kuwabara_kono, tsuji };
enum class Tension { allowed, clamped };
enum class EndKind { plate, wall, free };
enum class PlatePreload { balanced, as_printed };
enum class PlateModel { lumped, modal };
enum class PlateTheory { thin, thick };
enum class FluidLoad { none, added_mass, radiation };
/// Whether the discs of an array feel each other through the fluid.
enum class Coupling { fluid, none };

/// Relative L2 error of the velocities that a scene gets when it asks for nothing.
inline constexpr double default_accuracy = 1e-4;

/// The horn's tone burst (model: x_h(t) = A e(t) sin(2 pi (f t + (f_1 - f) t^2/(2 T)))), or its recorded motion.
struct Drive {
    /// live: samples come while a stream runs; none: there is no horn, and the preload alone holds the first sphere.
    DriveKind kind = DriveKind::tone;
    std::string material = "steel";
    double frequency_hz = 73e3;
    double cycles = 25;
    double amplitude_m = 3e-6;
    Envelope envelope = Envelope::hann;
    double taper = 0.2;        ///< fraction of a tukey burst spent rising and falling
    double repetition_hz = 0;  ///< bursts a second; 0: a single burst
    std::optional<double> sweep_to_hz =
        {};              ///< the frequency at the burst's end, to which it changes steadily; unset: it stays
    double start_s = 0;  ///< time before the first burst; of a live drive, its latency
    std::optional<std::string> file = {};        ///< of a record that is still to be read: drive_record.hpp
    std::optional<std::string> column = {};      ///< of the file; unset: the first
    std::optional<DriveQuantity> quantity = {};  ///< that was recorded; unset: displacement
    std::optional<double> sample_rate_hz = {};   ///< of the record; unset: the file's, or live the output's
    std::optional<double> scale = {};  ///< metres, or metres a second, for each unit of the record; unset: 1
    std::optional<double> lowpass_hz = {};  ///< unset: a third of the rate, at most 1 MHz
    std::vector<double> samples = {};       ///< the record; times scale [m] or [m/s], by quantity
    /// Of a live drive, whose frequency_hz, cycles and amplitude_m declare the drive for which the step is chosen.
    std::string endpoint = "tcp://127.0.0.1:5575";
    DriveSocket socket = DriveSocket::pull;
    OnUnderrun on_underrun = OnUnderrun::wait;
    HornModel horn = HornModel::prescribed;
    std::optional<double> horn_frequency_hz = {};  ///< of the resonator; unset: frequency_hz
    double horn_quality = 100;                     ///< Q of the resonator
    double horn_mass_kg = 0;                       ///< of its tip; 0: the chain does not act back on it
    bool operator==(const Drive&) const = default;
};

/// N spheres in a row, pressed together.
struct Spheres {
    std::string material = "aluminium";
    std::int64_t spheres = 6;
    double diameter_m = 1e-3;
    /// Repeated along the chain, in place of material and diameter_m; empty: all are alike.
    std::vector<std::string> materials = {};
    std::vector<double> diameters_m = {};
    double taper = 0;                              ///< sphere i has (1 - taper)^(i - 1) times its diameter
    double damping_kg_per_s = 0.32;                ///< of a dashpot
    DampingLaw damping_law = DampingLaw::dashpot;  ///< how closed contacts lose energy
    std::optional<double> damping_time_s;          ///< A of Kuwabara and Kono's law, which needs it
    std::optional<double> damping_alpha;           ///< alpha of Tsuji's law, which needs it
    double preload_n = 0.1;
    Tension tension = Tension::allowed;
    double gravity_m_per_s2 = 0;          ///< toward the end
    std::optional<double> holder_time_s;  ///< tau: the holder of the spheres takes (m/tau) v of each
    double impact_velocity_m_per_s = 0;   ///< of the first spheres at the start, toward the end
    std::int64_t impact_spheres = 1;      ///< how many they are
    /// Diameters differ at random by this part at most, each with the same chance, and preloads by theirs. The seed draws them; the elements
    /// of an array draw one after another.
    double tolerance = 0;
    double preload_tolerance = 0;
    std::int64_t seed = 1;
    bool operator==(const Spheres&) const = default;
};

/// The end that the last sphere presses against.
struct End {
    EndKind kind = EndKind::plate;
    std::string material = "vitreous_carbon";
    double radius_m = 5e-3;
    double thickness_m = 0.5e-3;
    std::optional<double> stiffness_n_per_m;  ///< unset: clamped-plate theory
    PlatePreload preload = PlatePreload::balanced;
    PlateModel model = PlateModel::lumped;  ///< the paper's mass and spring, or modes of the disc
    std::int64_t modes = 4;                 ///< of a modal plate
    double loss_factor = 0.005;             ///< of a modal plate's material: an assumption
    /// Of a modal plate: Kirchhoff's, or Mindlin's with shear and rotary inertia.
    PlateTheory theory = PlateTheory::thick;
    /// Of the disc's layers, from the sphere to the medium, in place of material, thickness_m and loss_factor; empty: one layer.
    std::vector<std::string> materials = {};
    std::vector<double> thicknesses_m = {};
    std::vector<double> loss_factors = {};  ///< empty: loss_factor, of each layer
    bool operator==(const End&) const = default;
};

/// The fluid that the transducer radiates into.
struct Medium {
    std::string material = "water";
    FluidLoad load = FluidLoad::radiation;  ///< its effect on a modal plate
    bool operator==(const Medium&) const = default;
};

/// Several chains, each with a disc of its own in one rigid baffle; none where it has no positions. Lists by element have an entry for
/// each, or one for all, or none: then all are as the rest of the scene says.
struct Array {
    std::vector<double> x_m = {};  ///< of the discs' centres, in the plane of the baffle
    std::vector<double> y_m = {};
    std::vector<double> delays_s = {};  ///< of the elements' drives, added to drive.start_s
    std::vector<double> preloads_n = {};
    std::vector<double> amplitudes_m = {};
    std::vector<std::string> materials = {};  ///< of the spheres
    std::vector<double> diameters_m = {};     ///< of the spheres
    /// x, y, z of a point where the sound of all elements arrives together: adds to the delays; empty: none.
    std::vector<double> focus_m = {};
    Coupling coupling = Coupling::fluid;
    bool operator==(const Array&) const = default;
};

/// How to integrate. At most one of step_s and accuracy may be given; unset members are chosen by resolve().
struct Numerics {
    std::optional<Integrator> integrator;
    std::optional<double> step_s;
    std::optional<double> accuracy;  ///< wanted relative L2 error of the velocities
    /// Between bursts, motion below this part of the horn's velocity is rest; 0: never.
    double rest_tolerance = 0;
    std::optional<std::int64_t> poles;  ///< of a modal plate's response in its fluid
    bool operator==(const Numerics&) const = default;
};

/// The samples that a run gives.
struct Output {
    double sample_rate_hz = 10e6;
    double duration_s = 500e-6;
    std::int64_t frame_samples = 1024;
    double hydrophone_m = 10e-3;  ///< distance on the plate's axis; for a modal plate
    /// Of the tap p_points: x, y, z from the centre of a modal plate, z along the axis into the fluid [m].
    std::vector<std::array<double, 3>> points_m{};
    bool operator==(const Output&) const = default;
};

/// Everything a user can set, in SI units; the defaults are the paper's values.
struct Scene {
    Drive drive;
    Spheres chain;
    End end;
    Medium medium;
    Array array;
    Numerics numerics;
    Output output;
    std::map<std::string, Material> materials;  ///< the scene's own, beside the built-in ones
    bool operator==(const Scene&) const = default;
};

/// The place of a key or a value.
struct Place {
    std::string origin;  ///< the file's name, or "--set chain.spheres=0"; empty: not known
    int line = 0;        ///< in the file, counted from 1; 0: no line in particular
};

/// A fault of a scene, of its text or of a --set option.
struct Fault {
    std::string key;      ///< "chain.spheres"; empty when the fault is not a key's
    std::string found;    ///< the value there, as text
    std::string allowed;  ///< the allowed values; empty: found is a sentence of its own
    Place place = {};     ///< where it stands, if the scene comes from a text

    /// "scene.toml:12: chain.spheres: found 0, allowed: an integer from 1 to 10000000"
    std::string message() const;
};

/// The messages of the faults, one after another.
std::string fault_text(std::span<const Fault> faults, std::string_view separator = "\n");

/// Every fault of the scene's values at once. resolve() (hertzline/resolve.hpp) then finds those that need the model: a drive without
/// its record, spheres that a taper makes too small, a step beyond the stability limit.
std::vector<Fault> validate(const Scene& scene);

/// A valid scene that leaves nothing open: integrator and step are set, by the user or by resolve().
class ResolvedScene {
public:
    /// Implicit: a scene with both is one. @param scene that of a Resolution without faults; for others the behaviour of a simulation is
    /// undefined @throws std::invalid_argument where one of them is open
    ResolvedScene(Scene scene);

    const Scene& scene() const noexcept { return scene_; }
    Integrator integrator() const noexcept { return *scene_.numerics.integrator; }
    /// Step of a grid, or the longest piece of a series [s].
    double step_s() const noexcept { return *scene_.numerics.step_s; }

private:
    Scene scene_;
};

/// The material of that name, the scene's own first; nullptr when there is none.
const Material* find_material(const Scene& scene, std::string_view name);

/// The names of all materials of that sort that the scene can use: the built-in ones, then its own.
std::vector<std::string> material_names(const Scene& scene, MaterialSort sort);

/// The solid of that name, the scene's own first. @throws std::out_of_range when there is none
const Solid& solid_of(const Scene& scene, std::string_view name);

/// Most samples of a record that drives the horn.
inline constexpr std::size_t max_drive_samples = 1'000'000;

/// Most entries of chain.materials and chain.diameters_m.
inline constexpr std::size_t max_sphere_entries = 1'000'000;

/// Most elements of an array.
inline constexpr std::size_t max_elements = 256;

/// Largest number of layers of a disc.
inline constexpr std::size_t max_layers = 16;

/// Most points of output.points_m; of a stream, far fewer (stream/).
inline constexpr std::size_t max_points = 1'000'000;

/// Largest number of spheres that a scene may ask for; 80 bytes of state and constants each.
inline constexpr std::int64_t max_spheres = 10'000'000;

}  // namespace hertzline
