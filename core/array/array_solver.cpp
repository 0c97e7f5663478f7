#include "core/array/array_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/scene/elements.hpp"

namespace hertzline {

namespace {

constexpr std::int64_t together = Water::most_asked;  // samples that are put together at once

bool couples(const Scene& scene) noexcept {
    return scene.array.coupling == Coupling::fluid && chains_of(scene) > 1;
}

/// The delay [s] by which the element is as the member; nothing where it is another chain. A record is cut off where it begins, and
/// chains that move from the start do not wait for their drives: those have to begin together.
std::optional<double> delay_behind(const ArrayMember& member, Scene& element) {
    const double delay_s = element.drive.start_s - member.scene.drive.start_s;
    const bool waits = element.drive.kind == DriveKind::tone && element.chain.impact_velocity_m_per_s == 0;
    const double longest_s = DelayedChains::longest / element.output.sample_rate_hz;
    if (delay_s != 0 && (!waits || delay_s > longest_s)) {
        return std::nullopt;
    }
    const double start_s = std::exchange(element.drive.start_s, member.scene.drive.start_s);
    const bool alike = element == member.scene;
    element.drive.start_s = start_s;
    return alike ? std::optional(delay_s) : std::nullopt;
}

}  // namespace

std::vector<ArrayMember> array_members(const Scene& scene) {
    std::vector<Scene> scenes;
    std::vector<std::size_t> in_time;  // the elements in the order of their delays
    for (std::size_t i = 0; i < chains_of(scene); ++i) {
        scenes.push_back(element_scene(scene, i));
        in_time.push_back(i);
    }
    std::ranges::stable_sort(in_time, {}, [&](std::size_t i) { return scenes[i].drive.start_s; });
    std::vector<ArrayMember> members;
    for (const std::size_t i : in_time) {
        std::optional<double> delay_s;
        for (auto member = members.begin(); member != members.end() && !couples(scene) && !delay_s;
             ++member) {
            if ((delay_s = delay_behind(*member, scenes[i]))) {
                member->elements.push_back({i, *delay_s});
            }
        }
        if (!delay_s) {
            members.push_back({std::move(scenes[i]), {{i, 0}}});
        }
    }
    std::ranges::sort(members, {}, [](const ArrayMember& member) { return member.elements.front().number; });
    return members;
}

ArraySolver::ArraySolver(const ResolvedScene& resolved, const SimulationOptions& options)
    : ArraySolver(resolved, options, array_members(resolved.scene())) {}

ArraySolver::ArraySolver(const ResolvedScene& resolved, const SimulationOptions& options,
                         std::vector<ArrayMember> members)
    : options_(options),
      places_(chains_of(resolved.scene())),
      team_(std::clamp<std::size_t>(options.threads, 1, members.size())) {
    const Scene& scene = resolved.scene();
    const auto samples_ahead =
        static_cast<std::size_t>(together + 64 + 4 * resolved.step_s() * scene.output.sample_rate_hz);
    const ChannelCounts counts{.spheres = 1, .points = scene.output.points_m.size()};
    for (ArrayMember& member : members) {
        DiscPlaces places{.discs = {}, .axis = middle_of(scene.array)};
        std::vector<double> delays_s;  // without those that are equal
        for (const auto& [element, delay_s] : member.elements) {
            places.discs.push_back({scene.array.x_m[element], scene.array.y_m[element], delay_s});
            if (delay_s > 0 && (delays_s.empty() || delay_s > delays_s.back())) {
                delays_s.push_back(delay_s);
            }
            places_[element] = {members_.size(),
                                delay_s > 0 ? std::optional(delays_s.size() - 1) : std::nullopt};
        }
        auto chain = std::make_unique<const Chain>(member.scene);
        auto delayed = delays_s.empty() ? nullptr
                                        : std::make_unique<DelayedChains>(*chain, member.scene, delays_s,
                                                                          options, samples_ahead);
        ResolvedScene of_member(std::move(member.scene));
        auto solver = std::make_unique<SeriesSolver>(of_member, *chain, options, places);
        if (delayed) {
            solver->lead(*delayed);
        }
        members_.push_back(
            std::make_unique<Member>(Member{.elements = std::move(member.elements),
                                            .scene = std::move(of_member),
                                            .chain = std::move(chain),
                                            .solver = std::move(solver),
                                            .block = Samples(options.taps, counts, samples_ahead),
                                            .delayed = std::move(delayed)}));
    }
    if (couples(scene)) {
        std::vector<const PlateResponse*> responses;
        for (const auto& member : members_) {
            responses.push_back(member->chain->end.plate.get());
        }
        std::vector<std::array<double, 3>> points;
        if (options.taps.contains(Tap::p_axis)) {
            const auto [x, y] = middle_of(scene.array);
            points.push_back({x, y, scene.output.hydrophone_m});
            has_axis_ = true;
        }
        if (options.taps.contains(Tap::p_points)) {
            points.insert(points.end(), scene.output.points_m.begin(), scene.output.points_m.end());
        }
        water_ = std::make_unique<Water>(
            scene, responses, resolved.step_s(), options.water_part, points,
            kernels::series_kernels(resolved.integrator(), 1, members_.front()->chain->damping_law));
        constexpr double heard = 1e-2;  // motion of a disc without a drive over that of the loudest
        double loudest = 0;
        for (const auto& member : members_) {
            loudest = std::max(loudest, member->solver->expected_velocity());
        }
        for (std::size_t i = 0; i < members_.size(); ++i) {
            members_[i]->solver->join(water_->disc(i), heard * loudest);
        }
    }
    reset();
}

std::vector<std::string> array_warnings(const Scene& scene) {
    constexpr std::size_t most = 37;  // that take no longer to be looked at than a moment
    if (chains_of(scene) < 2 || scene.medium.load != FluidLoad::radiation) {
        return {};
    }
    if (chains_of(scene) > most) {
        return couples(scene) ? std::vector<std::string>()
                              : std::vector<std::string>{
                                    "the discs do not feel each other (array.coupling); with more than 37 "
                                    "elements it is not worked out how much that changes"};
    }
    Scene coupled = scene;
    coupled.array.coupling = Coupling::fluid;
    coupled.numerics.rest_tolerance = 0;
    const ArraySolver solver(coupled, {.taps = {}, .ledger = LedgerKeeping::off});
    std::vector<std::string> warnings;
    if (!couples(scene)) {
        const double f = scene.drive.frequency_hz;
        std::array<char, 200> text{};
        std::snprintf(text.data(), text.size(),
                      "the discs do not feel each other (array.coupling): at %.3g Hz that changes the motion "
                      "of one of them by %.2g %%",
                      f, 100 * solver.water()->change_at(f));
        warnings.emplace_back(text.data());
        return warnings;
    }
    constexpr double rounding = 1e-5;
    const Water::Passivity passivity = solver.water()->passivity();
    if (passivity.least_resistance < -rounding || passivity.asymmetry > rounding) {
        std::array<char, 200> text{};
        std::snprintf(text.data(), text.size(),
                      "the water between the discs is not passive or not reciprocal by its tables: %.2g and "
                      "%.2g of the mobility",
                      -passivity.least_resistance, passivity.asymmetry);
        warnings.emplace_back(text.data());
    }
    return warnings;
}

void ArraySolver::reset() noexcept {
    if (water_) {
        water_->reset();
    }
    for (const auto& member : members_) {
        member->solver->reset();
        member->block.first = 0;
        member->block.count = 0;
        member->status = Status::running;
    }
    missing_ = {};
    missing_until_ = 0;
    next_sample_ = 0;
}

void ArraySolver::end_at(std::int64_t /*sample*/) noexcept {}
void ArraySolver::begin_with(const Motion& /*motion*/) noexcept {
    reset();
}

Status ArraySolver::worst() const noexcept {
    Status status = Status::running;
    for (const auto& member : members_) {
        if (member->status != Status::running && status != Status::unstable) {
            status = member->status;
        }
    }
    return status;
}

/// Discs that feel each other go a window of time at once.
Status ArraySolver::advance_together(std::int64_t until) noexcept {
    auto begin = [this](std::size_t i) noexcept {
        Member& member = *members_[i];
        water_->begin_window(i);
        const FixedTime end = water_->disc(i).window_end();
        member.status =
            member.solver->advance_to(end, &member.block, end.rounded_up() - member.solver->next_sample());
    };
    auto end = [this](std::size_t i) noexcept { water_->end_window(i); };
    while (water_->last_sample() < until) {
        team_.for_each(members_.size(), begin);
        if (const Status status = worst(); status != Status::running) {
            return status;
        }
        team_.for_each(members_.size(), end);
        water_->next_window();
    }
    return Status::running;
}

Status ArraySolver::advance(std::int64_t count, TapSet wanted) noexcept {
    if (water_) {
        for (const auto& member : members_) {
            member->block.holds = member->block.taps();
        }
        return advance_together(next_sample_ + count - 1);
    }
    auto work = [this, count, wanted](std::size_t i) noexcept {
        Member& member = *members_[i];
        member.block.holds = wanted;
        member.status = member.solver->produce(wanted.empty() ? nullptr : &member.block, count);
    };
    team_.for_each(members_.size(), work);
    return worst();
}

/// The samples ahead of delayed chains lack taps that were not wanted before.
void ArraySolver::ask_delayed(TapSet wanted) noexcept {
    if (next_sample_ >= missing_until_) {
        missing_ = {};
    }
    for (const auto& member : members_) {
        for (std::size_t d = 0; member->delayed && d < member->delayed->size(); ++d) {
            Samples& block = member->delayed->block(d);
            const TapSet fresh = (wanted & block.taps()) - block.holds;
            if (!fresh.empty() && block.count > 0) {
                missing_ |= fresh;
                missing_until_ =
                    std::max(missing_until_, block.first + static_cast<std::int64_t>(block.count));
            }
            block.holds = wanted & block.taps();
        }
    }
}

Status ArraySolver::produce(Samples* samples, std::int64_t count) noexcept {
    const TapSet wanted = samples != nullptr ? samples->holds : TapSet();
    ask_delayed(wanted);
    if (samples != nullptr) {
        samples->holds = wanted - missing_;
    }
    for (std::int64_t left = count; left > 0;) {
        const std::int64_t now = std::min(left, together);
        if (const Status status = advance(now, wanted); status != Status::running) {
            return status;
        }
        if (samples != nullptr) {
            put(*samples, now);
        }
        const auto take = [now](Samples& block) {
            if (block.count > 0) {
                block.drop(static_cast<std::size_t>(now));
            } else {
                block.first += now;
            }
        };
        for (const auto& member : members_) {
            take(member->block);
            for (std::size_t d = 0; member->delayed && d < member->delayed->size(); ++d) {
                take(member->delayed->block(d));
            }
        }
        next_sample_ += now;
        left -= now;
    }
    return Status::running;
}

const Samples& ArraySolver::block_of(std::size_t element) const noexcept {
    const auto& [member, delayed] = places_[element];
    return delayed ? members_[member]->delayed->block(*delayed) : members_[member]->block;
}

double ArraySolver::from_water(Tap tap, std::size_t channel, std::int64_t sample) const noexcept {
    switch (tap) {
        case Tap::v_face:
        case Tap::v_out:
            return water_->face(channel, sample);
        case Tap::p_axis:
            return water_->pressure(0, sample);
        case Tap::p_points:
            return water_->pressure(channel + (has_axis_ ? 1 : 0), sample);
        default:
            return 0;
    }
}

void ArraySolver::put(Samples& samples, std::int64_t count) noexcept {
    for (const Tap tap : samples.holds) {
        const bool by_element = row_of(tap).channels == Channels::per_element;
        const std::size_t channels = samples.channels(tap);
        double* const out = samples.room(tap).data() + samples.count * channels;
        for (std::size_t s = 0; s < static_cast<std::size_t>(count); ++s) {
            for (std::size_t channel = 0; channel < channels; ++channel) {
                double value = 0;
                if (by_element) {
                    value = block_of(channel)[tap][s];
                } else {
                    for (const auto& member : members_) {
                        value += member->block[tap][s * channels + channel];
                    }
                }
                if (water_) {
                    value += from_water(tap, channel, next_sample_ + static_cast<std::int64_t>(s));
                }
                out[s * channels + channel] = value;
            }
        }
    }
    samples.count += static_cast<std::size_t>(count);
}

std::int64_t ArraySolver::steps() noexcept {
    std::int64_t sum = 0;
    for (const auto& member : members_) {
        sum += member->solver->steps();
    }
    return sum;
}

std::int64_t ArraySolver::contact_events() const noexcept {
    std::int64_t sum = 0;
    for (const auto& member : members_) {
        for (const auto& [element, delay_s] : member->elements) {
            const DelayedChains::Account* const late = account_of(element);
            sum += late != nullptr ? late->contact_events : member->solver->contact_events();
        }
    }
    return sum;
}

const ChainState& ArraySolver::state(std::size_t element) noexcept {
    return members_[places_[element].member]->solver->state(0);
}

const Chain& ArraySolver::chain(std::size_t element) const noexcept {
    return *members_[places_[element].member]->chain;
}

Ledger ArraySolver::ledger() noexcept {
    Ledger sum;
    for (std::size_t i = 0; i < members_.size(); ++i) {
        Ledger one = members_[i]->solver->ledger();
        if (water_) {
            one.plate_lost = water_->lost(i);
            one.plate_held = water_->held(i);
        }
        for (const auto& [element, delay_s] : members_[i]->elements) {
            const DelayedChains::Account* const late = account_of(element);
            sum.add(late != nullptr ? late->ledger : one, 1);
        }
    }
    return sum;
}

Solver::Energy ArraySolver::energy() noexcept {
    Energy sum;
    for (const auto& member : members_) {
        const Energy one = member->solver->energy();
        for (const auto& [element, delay_s] : member->elements) {
            const DelayedChains::Account* const late = account_of(element);
            const Energy& of_element = late != nullptr ? late->energy : one;
            sum.kinetic += of_element.kinetic;
            sum.stored += of_element.stored;
        }
    }
    return sum;
}

/// Null: that of the member's chain itself.
const DelayedChains::Account* ArraySolver::account_of(std::size_t element) const noexcept {
    const auto& [member, delayed] = places_[element];
    return delayed ? members_[member]->delayed->account(*delayed, next_sample_) : nullptr;
}

double ArraySolver::memory_bytes(const Scene& scene, TapSet taps) {
    const auto elements = static_cast<double>(chains_of(scene));
    constexpr double of_plate = 2e6;  // its tables
    Scene small = scene;
    small.drive.samples.clear();
    small.output.points_m.clear();
    const double members = couples(scene) ? elements : static_cast<double>(array_members(small).size());
    double bytes = members * of_plate;
    // each chain has a copy of the scene
    bytes += elements * static_cast<double>(sizeof(double) * scene.drive.samples.size() +
                                            sizeof(scene.output.points_m[0]) * scene.output.points_m.size());
    const auto& fluid = std::get<Fluid>(*find_material(scene, scene.medium.material));
    // the sound of the farthest disc arrives last
    double farthest = 0;
    for (std::size_t i = 0; i < scene.array.x_m.size(); ++i) {
        farthest = std::max(farthest, 2 * std::hypot(scene.array.x_m[i], scene.array.y_m[i]));
    }
    const std::size_t heard = (taps.contains(Tap::p_points) ? scene.output.points_m.size() : 0) +
                              (taps.contains(Tap::p_axis) ? 1 : 0);
    constexpr double of_kernel = 64 * 72 * 8;
    bytes += elements * static_cast<double>(heard) *
             (of_kernel + 8 * farthest / fluid.sound_speed_m_per_s * scene.output.sample_rate_hz);
    if (couples(scene)) {
        constexpr double rows = 400;  // of a memory or of the modes' past
        const auto modes = static_cast<double>(scene.end.modes);
        const double distances = std::min(0.5 * elements * elements, 1e4);
        bytes +=
            8 * rows * modes * (distances * modes + 2 * elements + elements * static_cast<double>(heard));
    }
    return bytes + 8 * 1024 * channels_of(taps, channel_counts(scene));
}

double ArraySolver::fit_error() const noexcept {
    double worst = 0;
    for (const auto& member : members_) {
        worst = std::max(worst, member->solver->fit_error());
    }
    return worst + (water_ ? water_->fit_error() : 0);
}

std::string ArraySolver::failure() const {
    for (const auto& member : members_) {
        if (member->status == Status::unstable) {
            return "element " + std::to_string(member->elements.front().number + 1) + ": " +
                   member->solver->failure();
        }
    }
    return {};
}

}  // namespace hertzline
