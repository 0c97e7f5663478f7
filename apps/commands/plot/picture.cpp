#include "apps/commands/plot/picture.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/console/signals.hpp"
#include "core/scene/text.hpp"
#include "recordings/files/staged_file.hpp"
#include "recordings/recording_formats.hpp"

namespace hertzline::app {

namespace {

namespace fs = std::filesystem;

// exit statuses of the script
constexpr int plot_modules_missing = 3;  // a module of Python
constexpr int plot_not_a_sweep = 4;      // the file holds none

constexpr std::array endings{".png", ".svg", ".pdf"};

/// Names of Python. The path's comes first: a virtual environment may have matplotlib.
constexpr std::array pythons{"python3", "/usr/bin/python3"};

/// Makes a folder for the samples and the script that only its owner can open.
fs::path new_folder() {
    std::string name = fs::temp_directory_path() / "hertzline-plot-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) {
        recordings::cannot_write(name, std::generic_category().message(errno));
    }
    return name;
}

/// Returns a file's text, at most a few lines.
std::string beginning_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string text(4096, '\0');
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
    return printable(text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin));
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

/// Runs the script in the folder on a file, to draw the staged file. @returns its exit status if it can
/// draw, or nothing when it was stopped @throws std::runtime_error with the fault
std::optional<int> run_script(const fs::path& folder, recordings::StagedFile& picture,
                              const std::string& format, const fs::path& source,
                              const std::vector<std::string>& options) {
    const fs::path script = folder / "hertzline_plot.py";
    std::ofstream(script) << plot_script;
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
        if (exit_status == 0 || exit_status == plot_not_a_sweep) {
            return exit_status;
        }
        const std::string reason = last_line_of(beginning_of(messages));
        if (exit_status != plot_modules_missing) {
            recordings::cannot_write(picture.path(), fmt::format("{} failed: {}", python, reason));
        }
        missing = reason;
    }
    recordings::cannot_write(
        picture.path(),
        fmt::format("pictures need Python with matplotlib, those of a sweep in HDF5 h5py, too ({}); "
                    "on Debian: apt install python3-matplotlib python3-h5py",
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

}  // namespace

std::optional<std::string> picture_fault(const fs::path& picture) {
    if (std::ranges::find(endings, recordings::recording_ending(picture)) != endings.end()) {
        return std::nullopt;
    }
    return fmt::format("found {}, allowed: a name that ends in {}", quoted_briefly(picture.string()),
                       fmt::join(endings, ", "));
}

Picture::Picture(const fs::path& picture, const recordings::RecordingHead& head)
    : format_(recordings::recording_ending(picture).substr(1)),
      file_(picture, recordings::StagedFile::Devices::refused),
      folder_(new_folder()) {
    try {
        samples_ = recordings::open_recording(folder_ / "samples.npy", head);
    } catch (...) {
        std::error_code gone;
        fs::remove_all(folder_, gone);
        throw;
    }
}

Picture::~Picture() {
    std::error_code gone;
    fs::remove_all(folder_, gone);
}

void Picture::write(std::int64_t first, std::span<const double> values) {
    samples_->write(first, values);
}

bool Picture::draw(const std::string& title) {
    samples_->commit();
    if (!run_script(folder_, file_, format_, folder_ / "samples.npy", {"--title=" + title})) {
        return false;
    }
    file_.commit();
    return true;
}

Drawn draw_sweep(const fs::path& picture, const fs::path& table, std::span<const std::string> quantities,
                 const std::string& title) {
    recordings::StagedFile file(picture, recordings::StagedFile::Devices::refused);
    const Folder folder;
    std::vector<std::string> options{"--title=" + title};
    if (!quantities.empty()) {
        options.push_back(fmt::format("--quantity={}", fmt::join(quantities, ",")));
    }
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
