# The installed headers. Every other header is the project's own business and may change at any time.
#
# The sources include from the root of the project ("core/taps.hpp"); installed, the same header is <hertzline/core/taps.hpp>,
# so that no other project's core/ can come in its way. WritePublicHeaders.cmake writes the listed headers in that form.

set(core_headers
  # what one uses
  core/samples.hpp
  core/scene/integrator.hpp
  core/scene/materials.hpp
  core/scene/scene.hpp
  core/scene/scene_toml.hpp
  core/scene/scene_words.hpp
  core/scene/shipped_scenes.hpp
  core/simulation.hpp
  core/step_choice/resolve.hpp
  core/taps.hpp
  # what those include
  core/scene/json.hpp
  core/scene/fault.hpp
  core/model/bursts.hpp
  core/model/validity.hpp
  core/model/chain.hpp
  core/model/end.hpp
  core/plate/plate_modes.hpp
  core/plate/plate_response.hpp
  core/plate/rational_fit.hpp
  core/model/energy.hpp
  core/solvers/solver.hpp
  core/step_choice/pilot.hpp
  core/step_choice/reference_pilot.hpp
  core/step_choice/seen_motion.hpp
  core/step_choice/step_advice.hpp)

set(stream_headers
  # what one uses
  stream/pipeline/pipeline.hpp
  recordings/recording.hpp
  recordings/recording_formats.hpp
  recordings/recording_set.hpp
  stream/inputs/sample_source.hpp
  stream/control/hand_over.hpp
  stream/inputs/simulation_source.hpp
  recordings/float32.hpp
  measures/record_warnings.hpp
  measures/spectrum.hpp
  measures/quantities.hpp
  measures/run.hpp
  measures/scene_file.hpp
  stream/listening/listener.hpp
  stream/listening/run_receiver.hpp
  stream/wire/continuity.hpp
  stream/wire/frame_codec.hpp
  stream/wire/publisher.hpp
  stream/wire/subscriber.hpp
  # what those include
  stream/pipeline/capacity.hpp
  stream/pipeline/frame_sender.hpp
  stream/pipeline/pacer.hpp
  stream/pipeline/producer.hpp
  stream/pipeline/ring_buffer.hpp
  stream/pipeline/sleeper.hpp
  stream/pipeline/stream_monitor.hpp
  stream/threads.hpp
  recordings/columns.hpp
  stream/wire/sockets.hpp
  stream/wire/security/connections.hpp
  stream/wire/security/curve.hpp
  stream/wire/security/zap.hpp
  stream/wire/subscriptions.hpp
  stream/wire/topics.hpp)
