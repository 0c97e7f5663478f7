#pragma once
// `stream --control`: the options, and the sending thread's part when the scene changes.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/commands/listed_changes.hpp"
#include "apps/commands/publish_session.hpp"
#include "hertzline/resolve.hpp"
#include "stream/control/control_server.hpp"
#include "stream/control/scene_control.hpp"

namespace hertzline::app {

struct ControlRequest {
    std::string endpoint;                  ///< empty: no control
    std::vector<std::string> controllers;  ///< certificates, or folders of them
};

/// Adds --control and --allow-controllers. `request` must outlive the parsing.
void add_control_options(CLI::App& app, ControlRequest& request);

/// Reads the keys of the request; unset when controllers need none. Adds every fault. @param stream has the secret key
std::optional<stream::CurveServer> checked_control(const ControlRequest& request,
                                                   const CurveServerRequest& stream, Faults& faults);

/// The changes of a stream that is controlled. All but the constructor is for the sending thread.
class LiveControl {
public:
    /// @param resolved the scene that the source began with
    /// @param samples of the stream; unset: it has no end @param start of the stream
    /// @throws std::runtime_error when the endpoint cannot be bound
    LiveControl(const ControlRequest& request, const std::optional<stream::CurveServer>& curve,
                const Resolution& resolved, stream::SimulationSource& source,
                std::optional<std::int64_t> samples, stream::StreamStart start);

    const std::string& endpoint() const noexcept { return server_.endpoint(); }

    /// The stream does not wait any more.
    void stream_starts() noexcept { control_.stream_starts(); }

    /// Returns the changes up to the epoch, in order.
    std::vector<stream::EpochOfChange> begin(const Epoch& epoch);

    /// Adds to the members of meta that the stream is controlled, and the latest changes so far.
    void add_to(Json& meta) const;

    /// Answers those that wait, and later ones, that the stream has ended before its sample of this number.
    void end(std::int64_t sample) noexcept { server_.end(sample); }

private:
    stream::SceneControl control_;
    stream::ControlServer server_;
    ListedChanges changes_;
};

/// Returns a change for the log: "epoch 3 from sample 20000 on: drive.amplitude_m = 2e-06".
std::string change_text(const stream::SceneChange& change);

}  // namespace hertzline::app
