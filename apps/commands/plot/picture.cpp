#include "apps/commands/plot/picture.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/command.hpp"
#include "apps/commands/plot/plot_files.hpp"
#include "apps/console/signals.hpp"
#include "core/scene/json.hpp"
#include "core/scene/text.hpp"
#include "measures/provenance.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

// exit statuses of the script
constexpr int plot_modules_missing = 3;  // a module of Python
constexpr int plot_not_a_sweep = 4;      // the file holds none
constexpr int plot_wrong_use = 5;        // an option that the file cannot satisfy
constexpr int plot_unreadable = 6;       // a file

/// Names of Python. The path's comes first: a virtual environment may have matplotlib.
constexpr std::array pythons{"python3", "/usr/bin/python3"};

/// Returns the folder for temporary files.
fs::path temporary_place() {
    std::error_code missing;
    fs::path place = fs::temp_directory_path(missing);
    if (missing) {
        const char* const named = std::getenv("TMPDIR");  // NOLINT(concurrency-mt-unsafe): nothing sets it
        throw std::runtime_error(fmt::format("TMPDIR: found {}, allowed: a folder for temporary files",
                                             quoted_briefly(named != nullptr ? named : "/tmp")));
    }
    return place;
}

/// Makes a folder for the samples and the script that only its owner can open.
fs::path new_folder() {
    std::string name = temporary_place() / "hertzline-plot-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) {
        recordings::cannot_write(name, std::generic_category().message(errno));
    }
    return name;
}

/// Returns a file's text, at most a few lines.
std::string beginning_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string text(1 << 14, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    return text;
}

/// Returns the line of Python's error, fit for a terminal.
std::string last_line_of(const std::string& text) {
    const std::size_t end = text.find_last_not_of('\n');
    if (end == std::string::npos) {
        return "it gives no reason";
    }
    const std::size_t begin = text.rfind('\n', end);
    return printable(text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin), text.size());
}

/// Starts a program without input that writes its errors to a file. @returns its process, or nothing when it is not
/// installed
std::optional<pid_t> start(std::vector<std::string> words, const fs::path& messages) {
    std::vector<char*> arguments;
    std::ranges::transform(words, std::back_inserter(arguments),
                           [](std::string& word) { return word.data(); });
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
    std::signal(SIGCHLD, SIG_DFL);  // if it were ignored, waitpid() would not return the script's status
    pid_t process = -1;
    const int failure =
        ::posix_spawnp(&process, arguments.front(), &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    return failure == 0 ? std::optional(process) : std::nullopt;
}

/// Waits for the process to end, and kills it when the user asks to stop. @returns its status as of waitpid, or nothing when it was stopped
std::optional<int> wait_for(pid_t process) {
    constexpr std::chrono::milliseconds glance(10);
    int status = 0;
    while (::waitpid(process, &status, WNOHANG) == 0) {
        if (stop_asked()) {
            ::kill(process, SIGKILL);
            ::waitpid(process, &status, 0);
            return std::nullopt;
        }
        std::this_thread::sleep_for(glance);
    }
    return status;
}

/// Writes a temporary file.
void save_bytes(const fs::path& path, std::string_view bytes) {
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) {
        recordings::cannot_write(path, std::generic_category().message(errno));
    }
}

/// Runs the script in the folder on a file, to draw the staged file. @returns its exit status if it can
/// draw, or nothing when it was stopped @throws WrongUse, std::runtime_error with the fault
std::optional<int> run_script(const fs::path& folder, recordings::StagedFile& picture,
                              const std::string& format, const fs::path& source,
                              const std::vector<std::string>& options) {
    const fs::path script = folder / "hertzline_plot.py";
    for (const PlotFile& file : plot_files) {
        fs::create_directories((folder / file.path).parent_path());
        save_bytes(folder / file.path, file.text);
    }
    std::string missing;
    for (const char* python : pythons) {
        const fs::path messages = folder / "messages";
        std::vector<std::string> words{python, script, source, "-o", picture.temporary(), "--format", format};
        words.insert(words.end(), options.begin(), options.end());
        const auto process = start(std::move(words), messages);
        if (!process) {
            continue;
        }
        const std::optional<int> status = wait_for(*process);
        if (!status) {
            return std::nullopt;
        }
        const int exit_status = WIFEXITED(*status) ? WEXITSTATUS(*status) : -1;
        std::error_code unknown;
        if (exit_status == 0 && fs::file_size(picture.temporary(), unknown) == 0) {
            recordings::cannot_write(picture.path(), fmt::format("{} drew nothing", python));
        }
        if (exit_status == 0 || exit_status == plot_not_a_sweep) {
            return exit_status;
        }
        const std::string reason = last_line_of(beginning_of(messages));
        if (exit_status == plot_wrong_use) {
            throw WrongUse(reason);
        }
        if (exit_status == plot_unreadable) {
            throw std::runtime_error(reason);
        }
        if (exit_status != plot_modules_missing) {
            recordings::cannot_write(picture.path(), fmt::format("{} failed: {}", python, reason));
        }
        missing = reason;
    }
    recordings::cannot_write(
        picture.path(),
        fmt::format("pictures need Python with matplotlib, those of tables in HDF5 h5py, too, movies Pillow "
                    "({}); on Debian: apt install python3-matplotlib python3-h5py python3-pil",
                    missing.empty() ? "there is no python3" : missing));
}

/// The folder, for as long as the object lives.
class Folder {
public:
    Folder() : path(new_folder()) {}
    ~Folder() {
        std::error_code gone;
        fs::remove_all(path, gone);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    const fs::path path;
};

/// Writes the numbers of a picture: smallest and largest of each column's stretches, then each column's samples for the spectrum.
void save_numbers(const fs::path& path, const Outline& outline) {
    std::vector<double> numbers;
    for (std::size_t column = 0; column < outline.columns(); ++column) {
        numbers.insert(numbers.end(), outline.low(column).begin(), outline.low(column).end());
        numbers.insert(numbers.end(), outline.high(column).begin(), outline.high(column).end());
    }
    const std::vector<double>& rows = outline.longest().rows;
    for (std::size_t column = 0; column < outline.columns(); ++column) {
        for (std::size_t at = column; at < rows.size(); at += outline.columns()) {
            numbers.push_back(rows[at]);
        }
    }
    save_bytes(path, {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

/// The drive of a recording whose picture shows the horn, where it moved as a record did; null: otherwise.
Json recorded_drive(const recordings::RecordingHead& head) {
    const bool shows_horn = std::ranges::any_of(
        head.columns, [](const recordings::Column& column) { return column.quantity.ends_with("_horn"); });
    const OutsideJson provenance(head.provenance);
    return shows_horn && provenance.text("scene/drive/kind") == "file" ? provenance.at("scene/drive")
                                                                       : Json(nullptr);
}

/// Returns the script's options for a table.
std::vector<std::string> options_of(const SweepChoice& choice) {
    std::vector<std::string> options;
    if (!choice.quantities.empty()) {
        options.push_back(fmt::format("--quantity={}", fmt::join(choice.quantities, ",")));
    }
    if (!choice.waveforms.empty()) {
        options.push_back(fmt::format("--columns={}", fmt::join(choice.waveforms, ",")));
    }
    const FieldView& view = choice.view;
    if (!view.kind.empty()) {
        options.push_back("--kind=" + view.kind);
        options.push_back(fmt::format("--from={}", view.window.from_s));
        options.push_back(fmt::format("--to={}", view.window.to_s));
    }
    if (!view.at.empty()) {
        std::vector<std::string> points;
        for (const studies::Point& point : view.at) {
            points.push_back(fmt::format("{}", fmt::join(point, ",")));
        }
        options.push_back(fmt::format("--at={}", fmt::join(points, ";")));
    }
    if (view.frames) {
        options.push_back(fmt::format("--frames={}", *view.frames));
    }
    return options;
}

/// Describes a recording and its numbers for the script.
Json description_of(const RecordingOutline& recording) {
    const recordings::RecordingHead& head = recording.head;
    Json columns = Json::array();
    for (const recordings::Column& column : head.columns) {
        columns.push_back({column.name, column.quantity, column.unit});
    }
    const std::int64_t first = recording.outline.first();
    Json epochs = Json::array();  // that of the first sample, and those that begin in the picture
    for (const Epoch& epoch : measures::epochs_of(head.provenance, head.sample_rate_hz)) {
        if (epoch.first_sample <= first) {
            epochs.clear();
        }
        if (epoch.number > 0 && epoch.first_sample < recording.outline.end()) {
            epochs.push_back({epoch.number, static_cast<double>(std::max(epoch.first_sample, first)) /
                                                head.sample_rate_hz});
        }
    }
    const OutsideJson provenance(head.provenance);
    const Json drive{{"frequency_hz", provenance.at("scene/drive/frequency_hz")}};
    return {{"name", recording.name},
            {"columns", std::move(columns)},
            {"sample_rate_hz", head.sample_rate_hz},
            {"provenance", {{"scene", {{"drive", drive}}}, {"changes", provenance.at("changes")}}},
            {"band_from_hz", recording.band_from_hz ? Json(*recording.band_from_hz) : Json(nullptr)},
            {"drive", recorded_drive(head)},
            {"epochs", std::move(epochs)},
            {"first", recording.outline.first()},
            {"end", recording.outline.end()},
            {"width", recording.outline.width()},
            {"stretches", recording.outline.low(0).size()},
            {"part_first", recording.outline.longest().first}};
}

}  // namespace

std::vector<std::size_t> columns_in_picture(const recordings::RecordingHead& head,
                                            std::span<const std::size_t> chosen) {
    constexpr std::size_t max_columns = 1000;
    std::set<std::string> panels;
    std::vector<std::size_t> shown;
    for (const std::size_t column : chosen) {
        const auto& [name, quantity, unit] = head.columns[column];
        const std::string& panel = quantity.ends_with("_chain") ? quantity : name;
        if (shown.size() < max_columns && (panels.contains(panel) || panels.size() < max_picture_panels)) {
            panels.insert(panel);
            shown.push_back(column);
        }
    }
    return shown;
}

std::optional<std::string> picture_fault(const fs::path& picture, std::span<const char* const> endings) {
    if (std::ranges::find(endings, recordings::recording_ending(picture)) != endings.end()) {
        return std::nullopt;
    }
    return fmt::format("found {}, allowed: a name that ends in {}", quoted_briefly(picture.string()),
                       fmt::join(endings, ", "));
}

Drawn draw_recordings(const fs::path& picture, std::span<const RecordingOutline> drawn,
                      const std::string& title) {
    recordings::StagedFile file(picture, recordings::StagedFile::Devices::refused);
    const Folder folder;
    Json about = Json::array();
    for (const RecordingOutline& recording : drawn) {
        const std::string numbers = fmt::format("{}.f64", about.size());
        save_numbers(folder.path / numbers, recording.outline);
        about.push_back(description_of(recording));
        about.back()["numbers"] = numbers;
    }
    const fs::path source = folder.path / "recordings.json";
    save_bytes(source, json_text(about));
    if (!run_script(folder.path, file, recordings::recording_ending(picture).substr(1), source,
                    {"--title=" + title})) {
        return Drawn::stopped;
    }
    file.commit();
    return Drawn::yes;
}

Drawn draw_sweep(const fs::path& picture, const fs::path& table, const SweepChoice& choice,
                 const std::string& title) {
    recordings::StagedFile file(picture, recordings::StagedFile::Devices::refused);
    const Folder folder;
    std::vector<std::string> options = options_of(choice);
    options.push_back("--title=" + title);
    const auto status = run_script(folder.path, file, recordings::recording_ending(picture).substr(1),
                                   fs::absolute(table), options);
    if (!status) {
        return Drawn::stopped;
    }
    if (*status == plot_not_a_sweep) {
        return Drawn::no_sweep;
    }
    file.commit();
    return Drawn::yes;
}

}  // namespace hertzline::app
