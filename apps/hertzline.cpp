// The program: its subcommands.

#include <cstdlib>

#include "recordings/recording_thread.hpp"

#include "apps/command.hpp"
#include "apps/console/messages.hpp"
#include "apps/program.hpp"
#include "stream/control/scene_control.hpp"

namespace hertzline::app {

namespace {

constexpr const char* examples =
    "Examples:\n"
    "  hertzline run paper-vitreous-carbon -o burst.csv\n"
    "  hertzline stream paper-stream\n"
    "  hertzline listen --connect tcp://127.0.0.1:5573\n"
    "  hertzline plot burst.csv -o burst.png\n"
    "  hertzline scenes\n"
    "  hertzline check my-scene.toml\n"
    "Exit status: 0 done, 1 failed, 2 wrong use or wrong scene.";

/// In the order of --help.
std::vector<Subcommand> subcommands() {
    return {
        {"run", "simulate a scene as fast as possible, to files and a summary", run_command},
        {"sweep", "vary keys of a scene: simulate each point, to a table", sweep_command},
        {"optimise", "search ranges of a scene's keys for the best point, under bounds", optimise_command},
        {"stream", "simulate a scene in step with the clock and publish it", stream_command},
        {"replay", "publish a recording as if it were live", replay_command},
        {"listen", "receive a stream, check that nothing is missing, save it", listen_command},
        {"set", "change keys of a scene while it is streamed", set_command},
        {"get", "look at the scene of a running stream", get_command},
        {"scope", "show a stream in a browser", scope_command},
        {"plot", "draw waveforms and spectra of a recording", plot_command},
        {"scenes", "list the shipped scenes, or print one with every default resolved", scenes_command},
        {"materials", "list the built-in materials, their numbers and sources", materials_command},
        {"check", "validate a scene; print derived values and advice on its step", check_command},
        {"keys", "make a key pair for streams that encrypt", keys_command},
    };
}

}  // namespace

}  // namespace hertzline::app

int main(int argc, char** argv) {
    using namespace hertzline;
    app::prepare_process();
    const auto status = static_cast<int>(
        app::run_program({"hertzline", "real-time simulator of granular-chain ultrasound transducers",
                          app::examples, app::subcommands()},
                         argc, argv));
    app::finish_messages();
    if (recordings::RecordingThread::any_abandoned() || stream::SceneControl::any_abandoned()) {
        std::_Exit(status);  // it still uses what the ordinary end would destroy
    }
    return status;
}
