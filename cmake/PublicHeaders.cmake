# The installed headers. Every other header is internal and may change at any time.
#
# The sources include from the root of the project ("core/taps.hpp"). Installed, the same header is <hertzline/core/taps.hpp>, which
# cannot collide with another project's core/. WritePublicHeaders.cmake writes the listed headers in that form.

set(core_headers
  # for users
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
  # included by those
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
  # for users
  stream/pipeline/pipeline.hpp
  stream/pipeline/stream_options.hpp
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
  stream/wire/frame.hpp
  stream/wire/frame_codec.hpp
  stream/wire/publisher.hpp
  stream/wire/subscriber.hpp
  # included by those
  stream/pipeline/capacity.hpp
  stream/pipeline/frame_sender.hpp
  stream/pipeline/pacer.hpp
  stream/pipeline/producer.hpp
  stream/pipeline/ring_buffer.hpp
  stream/pipeline/sleeper.hpp
  stream/pipeline/stream_monitor.hpp
  stream/pipeline/thread_options.hpp
  stream/pipeline/topic_demand.hpp
  recordings/columns.hpp
  recordings/row_builder.hpp
  stream/inputs/run_id.hpp
  stream/wire/multipart.hpp
  stream/wire/security/connections.hpp
  stream/wire/security/curve.hpp
  stream/wire/socket_monitor.hpp
  stream/wire/security/peer_quota.hpp
  stream/wire/security/zap.hpp
  stream/wire/subscriptions.hpp
  stream/wire/topics.hpp)
