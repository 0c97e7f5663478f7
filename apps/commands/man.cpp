// hertzline man: manual pages in roff, made from the options of each subcommand and the tables of keys, outputs and numbers. The
// build writes all of them.

#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/arguments/choices.hpp"
#include "apps/arguments/options.hpp"
#include "apps/arguments/scene_argument.hpp"
#include "apps/command.hpp"
#include "apps/console/help.hpp"
#include "apps/console/markup.hpp"
#include "apps/console/output.hpp"
#include "core/scene/scene_key.hpp"
#include "core/scene/text.hpp"
#include "hertzline/materials.hpp"
#include "hertzline/scene_file.hpp"
#include "hertzline/taps.hpp"
#include "measures/provenance.hpp"
#include "measures/quantities.hpp"

namespace hertzline::app {

namespace {

constexpr const char* man_examples =
    "PAGE is a subcommand, or scene for the keys of scene files; without PAGE, the program's own page. "
    "Without "
    "-o the page is printed, as the source that man formats.\n"
    "Examples:\n"
    "  hertzline man run | man -l -\n"
    "  hertzline man scene | man -l -\n"
    "  hertzline man -o /usr/local/share/man";

struct ManOptions {
    std::string page;
    std::string folder;
};

constexpr const char* scene_page_name = "scene";

constexpr const char* documents =
    "Documents that these pages name, such as docs/measures.md and scenes/README.md, are part of the "
    "sources. Debian's package hertzline-doc has them in /usr/share/doc/hertzline.";

std::string heading(std::string_view text) {
    return fmt::format(".SH {}\n", text);
}

/// An entry of a list: a term in bold, the rest of its line, and a paragraph.
std::string entry(std::string_view term, std::string_view more, std::string_view markdown) {
    return fmt::format(".TP\n\\fB{}\\fR{}\n{}", roff_text(term), roff_text(more), roff_paragraph(markdown));
}

/// The beginning of a page. @param name "hertzline-run"
std::string page_head(std::string_view name, int section, std::string_view description) {
    std::string upper(name);
    for (char& c : upper) {
        c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    return fmt::format(".TH {} {} \"\" \"hertzline {}\"\n.nh\n.ad l\n{}{} \\- {}\n", roff_text(upper),
                       section, measures::program_version(), heading("NAME"), roff_text(name),
                       roff_text(plain_text(description)));
}

/// The end of a page: the pages of the program, without this one. @param own "hertzline-run(1)"
std::string see_also(const CLI::App& program, std::string_view own) {
    std::vector<std::string> pages{"hertzline(1)"};
    for (const CLI::App* app : program.get_subcommands({})) {
        pages.push_back(fmt::format("hertzline-{}(1)", app->get_name()));
    }
    pages.push_back(fmt::format("hertzline-{}(5)", scene_page_name));
    std::erase(pages, own);
    std::string text = heading("SEE ALSO");
    for (const std::string& page : pages) {
        const std::size_t bracket = page.find('(');
        text += fmt::format(".BR {} {}{}\n", roff_text(page.substr(0, bracket)), page.substr(bracket),
                            &page == &pages.back() ? "" : ",");
    }
    return text;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
    return app.get_options([positional](const CLI::Option* option) {
        return !option->get_group().empty() && option->get_positional() == positional;
    });
}

/// @throws std::logic_error for an option without a description, or whose values completion does not know
std::string option_entry(const CLI::Option& option) {
    if (option.get_description().empty()) {
        throw std::logic_error(fmt::format("{} has no description", option.get_name()));
    }
    if (takes_value(option)) {
        choices_of(option.get_name(), word_of(option), "");
    }
    const bool positional = option.get_positional();
    std::string names = option.get_name(positional, !positional);
    if (const std::size_t comma = names.find(','); comma != std::string::npos) {
        names.insert(comma + 1, " ");
    }
    const std::string value = takes_value(option) && !positional ? ' ' + word_of(option) : "";
    const std::string more = !positional && option.get_expected_max() > 1 ? "..." : "";
    const std::string standard =
        option.get_default_str().empty() ? "" : fmt::format(" (default: {})", option.get_default_str());
    return entry(names, value + more,
                 option.get_description() + standard + (option.get_required() ? "; required" : ""));
}

std::string synopsis(const CLI::App& app, std::string_view command) {
    std::string text = fmt::format("{}.B {}\n", heading("SYNOPSIS"), roff_text(command));
    for (const CLI::Option* option : options_of(app, false)) {
        if (option->get_required()) {
            text += fmt::format("\\fB{}\\fR \\fI{}\\fR\n", roff_text(option->get_name(false, false)),
                                roff_text(option->get_type_name()));
        }
    }
    text += "[\\fIoptions\\fR]\n";
    for (const CLI::Option* option : options_of(app, true)) {
        const bool several = option->get_expected_max() > 1;
        text += fmt::format("{}\\fI{}\\fR{}{}\n", option->get_required() ? "" : "[",
                            roff_text(option->get_name(true, false)), several ? "..." : "",
                            option->get_required() ? "" : "]");
    }
    return text;
}

std::string option_list(const CLI::App& app) {
    std::string text;
    if (const auto arguments = options_of(app, true); !arguments.empty()) {
        text += heading("ARGUMENTS");
        for (const CLI::Option* option : arguments) {
            text += option_entry(*option);
        }
    }
    text += heading("OPTIONS");
    for (const CLI::Option* option : options_of(app, false)) {
        text += option_entry(*option);
    }
    return text;
}

constexpr std::size_t command_indent = 2;  // of commands in a footer; their next lines have more

/// Lines of a footer: paragraphs, and commands that begin with a blank.
std::string footer_part(const std::vector<std::string>& lines) {
    std::string text;
    std::string prose;
    bool commands = false;
    const auto separator = [&text] { return text.empty() ? "" : ".PP\n"; };
    const auto end_prose = [&] {
        text += prose.empty() ? "" : separator() + roff_paragraph(prose);
        prose.clear();
    };
    for (const std::string& line : lines) {
        const bool command = line.starts_with(' ');
        if (command != commands) {
            end_prose();
            text += command ? separator() + std::string(".nf\n.RS 4\n") : ".RE\n.fi\n";
            commands = command;
        }
        if (command) {
            text += roff_text(line.substr(command_indent)) + '\n';
        } else {
            prose += line + ' ';
        }
    }
    end_prose();
    return text + (commands ? ".RE\n.fi\n" : "");
}

struct Footer {
    std::vector<std::string> description;
    std::vector<std::string> examples;  ///< with the prose between them
};

Footer footer_of(const CLI::App& app) {
    Footer footer;
    std::istringstream lines(app.get_footer());
    bool in_examples = false;
    for (std::string line; std::getline(lines, line);) {
        if (line == "Examples:") {
            in_examples = true;
        } else if (line != exit_statuses) {
            (in_examples ? footer.examples : footer.description).push_back(line);
        }
    }
    return footer;
}

/// The outputs of a simulation and the numbers of its summary, for the page of `run`.
std::string tables_of_run() {
    std::string text = heading("OUTPUTS");
    text += roff_paragraph("The column is the name in a file, where `#` stands for the number of a channel.");
    for (const TapRow& row : tap_rows) {
        text += entry(
            row.name, fmt::format(" [{}]", row.unit),
            fmt::format("{}{}; column `{}`", row.doc, row.streamed ? "" : ", not streamed", row.column));
    }
    text += heading("NUMBERS OF THE SUMMARY");
    text += roff_paragraph(
        "f is the frequency of the drive, V_k the height of the line of the spectrum at k f. "
        "docs/measures.md (DOCUMENTS in hertzline(1)) explains the numbers at length.");
    for (const measures::Quantity& quantity : measures::quantities()) {
        const bool of_tap = quantity.unit == "tap";
        text += entry(of_tap ? "peak_v_out_m_per_s" : quantity.name,
                      of_tap                  ? " [m/s]"
                      : quantity.unit.empty() ? ""
                                              : fmt::format(" [{}]", quantity.unit),
                      quantity.definition);
    }
    return text;
}

std::string subcommand_list(const CLI::App& program) {
    std::string text = heading("COMMANDS");
    for (const CLI::App* app : program.get_subcommands({})) {
        text += fmt::format(".TP\n.BR {} (1)\n{}", roff_text("hertzline-" + app->get_name()),
                            roff_paragraph(app->get_description()));
    }
    return text;
}

/// The page of a subcommand, or of the program, which is its own parent.
std::string command_page(const CLI::App& program, const CLI::App& app) {
    const bool whole = &app == &program;
    const std::string name = whole ? "hertzline" : "hertzline-" + app.get_name();
    const std::string command = whole ? "hertzline" : "hertzline " + app.get_name();
    const Footer footer = footer_of(app);
    std::string text = page_head(name, 1, app.get_description()) + synopsis(app, command);
    text += whole ? "[\\fIcommand\\fR]\n" : "";
    if (!footer.description.empty()) {
        text += heading("DESCRIPTION") + footer_part(footer.description);
    }
    text += whole ? subcommand_list(program) : "";
    text += option_list(app);
    text += app.get_name() == "run" ? tables_of_run() : "";
    text += heading("EXIT STATUS");
    text += roff_paragraph(std::string(exit_statuses).substr(std::string("Exit status: ").size()));
    text += heading("EXAMPLES") + footer_part(footer.examples);
    text += whole ? heading("DOCUMENTS") + roff_paragraph(documents) : "";
    return text + see_also(program, name + "(1)");
}

std::string key_entry(const SceneKey& key) {
    return entry(key.name, "",
                 fmt::format("{}. Default: {}. Allowed: {}.", key.doc, default_text(key), key.allowed()));
}

std::string scene_page(const CLI::App& program) {
    const std::string name = fmt::format("hertzline-{}", scene_page_name);
    std::string text = page_head(name, 5, "scene files of hertzline: a device and its drive");
    text += heading("DESCRIPTION");
    text += roff_paragraph(
        "A scene is a TOML file in SI units, a table for each section. Every key has a default, so a file "
        "gives the "
        "differences only. `hertzline check` lists all faults of a file, each with its line; `--set "
        "section.key=value` "
        "overrides a key. A number may be a text with its unit.");
    text += heading("KEYS");
    std::string section;
    for (const SceneKey& key : documented_keys()) {
        if (key.section() != section) {
            section = key.section();
            text += fmt::format(".SS [{}]\n", section);
        }
        text += key_entry(key);
    }
    text += heading("MATERIALS");
    for (const BuiltInMaterial& row : built_in_materials()) {
        text += entry(row.name, sort_of(row.material) == MaterialSort::solid ? " (solid)" : " (fluid)",
                      row.source);
    }
    text += heading("SHIPPED SCENES");
    for (const ShippedScene& scene : shipped_scenes()) {
        text += entry(scene.name, "", scene.description);
    }
    text += heading("EXAMPLES");
    text +=
        ".nf\n.RS 4\n[chain]\nspheres = 10\npreload_n = 0.2\n.PP\n[end]\nmaterial = \"pyrex\"\n"
        "thickness_m = \"0.4 mm\"\n.RE\n.fi\n";
    return text + see_also(program, name + "(5)");
}

void write_page(const std::filesystem::path& folder, const std::string& name, int section,
                const std::string& text) {
    const std::filesystem::path place = folder / fmt::format("man{}", section);
    std::error_code fault;
    std::filesystem::create_directories(place, fault);
    const std::filesystem::path file = place / fmt::format("{}.{}", name, section);
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (!out) {
        throw std::runtime_error(fmt::format("{} cannot be written", printable_whole(file.string())));
    }
}

void write_pages(const CLI::App& program, const std::filesystem::path& folder) {
    write_page(folder, "hertzline", 1, command_page(program, program));
    for (const CLI::App* app : program.get_subcommands({})) {
        write_page(folder, "hertzline-" + app->get_name(), 1, command_page(program, *app));
    }
    write_page(folder, fmt::format("hertzline-{}", scene_page_name), 5, scene_page(program));
}

std::string page_named(const CLI::App& program, const std::string& name) {
    if (name.empty()) {
        return command_page(program, program);
    }
    if (name == scene_page_name) {
        return scene_page(program);
    }
    std::vector<std::string> allowed{scene_page_name};
    for (const CLI::App* app : program.get_subcommands({})) {
        if (app->get_name() == name) {
            return command_page(program, *app);
        }
        allowed.push_back(app->get_name());
    }
    throw WrongUse(fmt::format("PAGE: found {}, allowed: {}{}", quoted_briefly(name),
                               comma_separated(allowed), suggestion(name, allowed)));
}

Exit man(const CLI::App& program, const ManOptions& options) {
    if (options.folder.empty()) {
        print_listing(page_named(program, options.page));
        return Exit::done;
    }
    if (!options.page.empty()) {
        throw WrongUse("-o: found a PAGE, allowed: none, since it writes all pages");
    }
    write_pages(program, options.folder);
    return Exit::done;
}

}  // namespace

Run man_command(CLI::App& app) {
    auto options = std::make_shared<ManOptions>();
    app.add_option("PAGE", options->page, "the page of a subcommand, or of scene files")->type_name("");
    app.add_option("-o,--output", options->folder,
                   "write all pages into this folder, as man1/ and man5/ of it")
        ->check(missing_name)
        ->type_name("FOLDER");
    app.footer(man_examples);
    return [options, &app] { return man(*app.get_parent(), *options); };
}

}  // namespace hertzline::app
