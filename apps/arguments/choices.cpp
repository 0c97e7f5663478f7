#include "apps/arguments/choices.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/command.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "core/simd/target_choice.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/taps.hpp"
#include "measures/quantities.hpp"
#include "measures/run.hpp"

namespace hertzline::app {

namespace {

using List = std::vector<Choice>;

/// The choices, each after the entries of the list that were typed before; without those entries.
List in_list(const List& choices, std::string_view typed) {
    const std::string before(typed.substr(0, typed.rfind(',') + 1));  // nothing where there is no comma
    const std::vector<std::string_view> given = split(before, ',');
    List list;
    for (const Choice& choice : choices) {
        if (std::ranges::find(given, choice.text) == given.end()) {
            list.push_back({before + choice.text, choice.doc});
        }
    }
    return list;
}

List words(std::initializer_list<const char*> texts) {
    List list;
    for (const char* text : texts) {
        list.push_back({text, ""});
    }
    return list;
}

List scene_names(std::string_view /*typed*/) {
    List list;
    for (const ShippedScene& scene : shipped_scenes()) {
        list.push_back({std::string(scene.name), std::string(scene.description)});
    }
    return list;
}

List key_names(std::string_view /*typed*/) {
    List list;
    for (const SceneKey& key : scene_keys()) {
        list.push_back({key.name, key.range.unit.empty() ? std::string(key.doc)
                                                         : fmt::format("[{}] {}", key.range.unit, key.doc)});
    }
    return list;
}

/// The words of the key before the sign of equality; a number has none, and a list stands in brackets.
List words_of_key(std::string_view name) {
    List list;
    const auto key = scene_key_named(Scene{}, name);
    if (key && !key->is_list()) {
        for (const std::string& word : words_of(Scene{}, *key)) {
            list.push_back({word, ""});
        }
    }
    return list;
}

template <bool several>
List assignments(std::string_view typed) {
    const std::size_t equals = typed.find('=');
    if (equals == std::string_view::npos) {
        List list = key_names(typed);
        for (Choice& choice : list) {
            choice.text += '=';
        }
        return list;
    }
    List list = words_of_key(typed.substr(0, equals));
    if (several) {
        list = in_list(list, typed.substr(equals + 1));
    }
    for (Choice& choice : list) {
        choice.text.insert(0, typed.substr(0, equals + 1));
    }
    return list;
}

List taps(TapSet there) {
    List list;
    for (const Tap tap : there) {
        list.push_back(
            {std::string(row_of(tap).name), fmt::format("[{}] {}", row_of(tap).unit, row_of(tap).doc)});
    }
    return list;
}

template <bool whole_arrays>
List numbers(std::string_view /*typed*/) {
    using measures::Kind;
    List list;
    std::set<std::string> names;
    for (const measures::NumberColumn& column : measures::number_columns({}, true)) {
        const Kind kind = column.quantity->kind;
        const bool is_array = kind == Kind::harmonics || kind == Kind::points;
        const std::string name = is_array && whole_arrays ? std::string(column.quantity->name) : column.name;
        if (names.insert(name).second) {
            list.push_back({name, std::string(column.quantity->definition)});
        }
    }
    return list;
}

List targets(std::string_view /*typed*/) {
    List list;
    for (const std::string& name : kernels::kernel_targets()) {
        list.push_back({name, ""});
    }
    return list;
}

List pages(std::string_view /*typed*/) {
    List list{{"scene", "the keys of scene files"}};
#define HERTZLINE_PAGE(name, description) list.push_back({#name, description});
    HERTZLINE_SUBCOMMANDS(HERTZLINE_PAGE)
#undef HERTZLINE_PAGE
    return list;
}

struct Row {
    std::string_view word;  ///< in --help; after an option, of that option alone
    Paths paths = Paths::none;
    List (*choices)(std::string_view typed) = nullptr;
};

constexpr std::array rows{
    Row{"SCENE", Paths::files, scene_names},
    Row{"KEY", Paths::none, key_names},
    Row{"KEY=VALUE", Paths::none, assignments<false>},
    Row{"KEY=VALUES", Paths::none, assignments<true>},
    Row{"--measure OUTPUT", Paths::none, [](std::string_view) { return taps(measures::measurable_taps); }},
    Row{"OUTPUT", Paths::none, [](std::string_view) { return taps(all_taps); }},
    Row{"STREAM", Paths::none, [](std::string_view) { return taps(streamed_taps); }},
    Row{"QUANTITY", Paths::none, numbers<true>},
    Row{"MEASURE", Paths::none, numbers<false>},
    Row{"BOUND", Paths::none, numbers<false>},
    Row{"TARGET", Paths::none, targets},
    Row{"PACE", Paths::none,
        [](std::string_view) {
            return words({"realtime", "flat-out"});
        }},
    Row{"SHELL", Paths::none,
        [](std::string_view) {
            return words({"bash", "zsh", "fish"});
        }},
    Row{"PAGE", Paths::none, pages},
    Row{"FILE", Paths::files},
    Row{"FOLDER", Paths::folders},
    Row{"FILE|FOLDER", Paths::files},
    Row{"RECORDING", Paths::files},
    Row{"JOURNAL", Paths::files},
    Row{"NAME", Paths::files},
    Row{"N"},
    Row{"S"},
    Row{"HZ"},
    Row{"TIME"},
    Row{"BYTES"},
    Row{"M_PER_S"},
    Row{"WORD"},
    Row{"ENDPOINT"},
    Row{"HOST:PORT"},
    Row{"ADDRESS:PORT"},
    Row{"x=..,y=..,z=.."},
};

/// The words in lower case of "I/N|slurm[/N]|mpi", which are typed as they are.
List literal_words(std::string_view word) {
    List list;
    for (const std::string_view part : split(word, '|')) {
        const std::string_view text = part.substr(0, part.find('['));
        if (!text.empty() &&
            text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == std::string_view::npos) {
            list.push_back({std::string(text), ""});
        }
    }
    return list;
}

}  // namespace

Choices choices_of(std::string_view option, std::string_view word, std::string_view typed) {
    constexpr std::string_view list_end = ",...";
    const bool is_list = word.ends_with(list_end);
    const std::string_view one = word.substr(0, word.size() - (is_list ? list_end.size() : 0));
    const std::string of_option = fmt::format("{} {}", option, one);
    const auto row = std::ranges::find_if(
        rows, [&](const Row& candidate) { return candidate.word == one || candidate.word == of_option; });
    if (row != rows.end()) {
        List list = row->choices != nullptr ? row->choices(typed) : List{};
        return {row->paths, is_list ? in_list(list, typed) : std::move(list)};
    }
    List list = literal_words(one);
    if (list.empty()) {
        throw std::logic_error(fmt::format("apps/arguments/choices.cpp has no row for {}", one));
    }
    return {Paths::none, std::move(list)};
}

}  // namespace hertzline::app
