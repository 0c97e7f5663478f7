#pragma once
// The words that stand for the choices of a Scene, in scene files and in messages. A new choice is one word
// here; that of an integrator stands in its row (integrator.hpp).

#include <algorithm>
#include <array>
#include <string_view>

#include "hertzline/scene.hpp"

namespace hertzline {

template <class Choice>
struct Word {
    std::string_view text;
    Choice choice;
};

template <class Choice>
struct Words;  // Words<Envelope>::all and so on

template <>
struct Words<DriveKind> {
    static constexpr std::array all{
        Word<DriveKind>{"tone", DriveKind::tone}, Word<DriveKind>{"file", DriveKind::file},
        Word<DriveKind>{"live", DriveKind::live}, Word<DriveKind>{"none", DriveKind::none}};
};

template <>
struct Words<DriveSocket> {
    static constexpr std::array all{Word<DriveSocket>{"pull", DriveSocket::pull},
                                    Word<DriveSocket>{"sub", DriveSocket::sub}};
};

template <>
struct Words<OnUnderrun> {
    static constexpr std::array all{Word<OnUnderrun>{"wait", OnUnderrun::wait},
                                    Word<OnUnderrun>{"zero", OnUnderrun::zero}};
};

template <>
struct Words<DriveQuantity> {
    static constexpr std::array all{Word<DriveQuantity>{"displacement", DriveQuantity::displacement},
                                    Word<DriveQuantity>{"velocity", DriveQuantity::velocity}};
};

template <>
struct Words<HornModel> {
    static constexpr std::array all{Word<HornModel>{"prescribed", HornModel::prescribed},
                                    Word<HornModel>{"resonator", HornModel::resonator}};
};

template <>
struct Words<Envelope> {
    static constexpr std::array all{Word<Envelope>{"hann", Envelope::hann},
                                    Word<Envelope>{"tukey", Envelope::tukey},
                                    Word<Envelope>{"rectangular", Envelope::rectangular}};
};

template <>
struct Words<DampingLaw> {
    static constexpr std::array all{Word<DampingLaw>{"dashpot", DampingLaw::dashpot},
                                    Word<DampingLaw>{"kuwabara_kono", DampingLaw::kuwabara_kono},
                                    Word<DampingLaw>{"tsuji", DampingLaw::tsuji}};
};

template <>
struct Words<Tension> {
    static constexpr std::array all{Word<Tension>{"allowed", Tension::allowed},
                                    Word<Tension>{"clamped", Tension::clamped}};
};

template <>
struct Words<EndKind> {
    static constexpr std::array all{Word<EndKind>{"plate", EndKind::plate},
                                    Word<EndKind>{"wall", EndKind::wall},
                                    Word<EndKind>{"free", EndKind::free}};
};

template <>
struct Words<PlatePreload> {
    static constexpr std::array all{Word<PlatePreload>{"balanced", PlatePreload::balanced},
                                    Word<PlatePreload>{"as_printed", PlatePreload::as_printed}};
};

template <>
struct Words<PlateModel> {
    static constexpr std::array all{Word<PlateModel>{"lumped", PlateModel::lumped},
                                    Word<PlateModel>{"modal", PlateModel::modal}};
};

template <>
struct Words<PlateTheory> {
    static constexpr std::array all{Word<PlateTheory>{"thin", PlateTheory::thin},
                                    Word<PlateTheory>{"thick", PlateTheory::thick}};
};

template <>
struct Words<FluidLoad> {
    static constexpr std::array all{Word<FluidLoad>{"none", FluidLoad::none},
                                    Word<FluidLoad>{"added_mass", FluidLoad::added_mass},
                                    Word<FluidLoad>{"radiation", FluidLoad::radiation}};
};

template <>
struct Words<Coupling> {
    static constexpr std::array all{Word<Coupling>{"fluid", Coupling::fluid},
                                    Word<Coupling>{"none", Coupling::none}};
};

template <>
struct Words<Integrator> {
    static constexpr auto all = [] {
        std::array<Word<Integrator>, methods.size()> words{};
        std::transform(methods.begin(), methods.end(), words.begin(), [](const Method& row) {
            return Word<Integrator>{row.word, row.integrator};
        });
        return words;
    }();
};

/// Every choice, in the order of the words, for loops over them.
template <class Choice>
inline constexpr auto choices = [] {
    std::array<Choice, Words<Choice>::all.size()> every{};
    std::transform(Words<Choice>::all.begin(), Words<Choice>::all.end(), every.begin(),
                   [](const Word<Choice>& entry) { return entry.choice; });
    return every;
}();

/// The word for a choice, word(Envelope::hann) == "hann"; empty for a value that is no choice.
template <class Choice>
constexpr std::string_view word(Choice choice) noexcept {
    for (const auto& entry : Words<Choice>::all) {
        if (entry.choice == choice) {
            return entry.text;
        }
    }
    return {};
}

}  // namespace hertzline
