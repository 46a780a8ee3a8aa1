// SPDX-License-Identifier: Apache-2.0
// Streams merged by their stamps.
#include "slipwise/online/recording.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <limits>
#include <variant>

namespace slipwise {
namespace {

/// Hands each measurement to `receiver`, in the order of the stamps and, at one stamp, of the kinds.
template <typename Receiver>
void merge(const Recording& run, Receiver&& receiver) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  constexpr std::size_t kOthers = std::variant_size_v<Measurement> - 1;  // readings come last
  const auto next = [](const auto& samples, std::size_t i) { return i < samples.size() ? samples[i].t : kEnd; };
  std::array<std::size_t, kOthers + kReadingKinds> at{};
  std::size_t count =
      run.commands.size() + run.wheels.size() + run.forces.size() + run.attitudes.size() + run.poses.size();
  for (const auto& readings : run.readings) {
    count += readings.size();
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, kOthers + kReadingKinds> stamps{next(run.commands, at[0]), next(run.wheels, at[1]),
                                                       next(run.forces, at[2]), next(run.attitudes, at[3]),
                                                       next(run.poses, at[4])};
    for (std::size_t kind = 0; kind < kReadingKinds; ++kind) {
      stamps.at(kOthers + kind) = next(run.readings.at(kind), at.at(kOthers + kind));
    }
    const auto stream = static_cast<std::size_t>(std::ranges::min_element(stamps) - stamps.begin());
    const std::size_t place = at.at(stream)++;
    switch (stream) {
      case 0:
        receiver(Measurement(CommandSample{run.commands[place]}));
        break;
      case 1:
        receiver(Measurement(WheelSample{run.wheels[place]}));
        break;
      case 2:
        receiver(Measurement(run.forces[place]));
        break;
      case 3:
        receiver(Measurement(run.attitudes[place]));
        break;
      case 4:
        receiver(Measurement(run.poses[place]));
        break;
      default:
        receiver(Measurement(run.readings.at(stream - kOthers)[place]));
    }
  }
}

/// A stream that cuts nothing to hold predictions against, for callers who take none of it.
SegmentStream without_targets(StreamSettings settings) {
  settings.horizons.clear();
  return SegmentStream(settings);
}

/// Drives a stream through a run.
void stream_run(SegmentStream& stream, const Recording& run) {
  stream.start_run();
  merge(run, [&](const Measurement& measurement) { stream.push(measurement); });
  stream.end_run();
}

struct ToGate {
  InputBuffer commands;
  InputBuffer wheels_known;
  PoseGate gate;
  GatedPoses found;

  explicit ToGate(double unknown_after) : commands(unknown_after), wheels_known(unknown_after) {}
  const InputBuffer& inputs() const { return wheels_known.empty() ? commands : wheels_known; }
  void add(const GatedPoses& more) {
    const auto append = [](auto& all, const auto& some) { all.insert(all.end(), some.begin(), some.end()); };
    append(found.accepted, more.accepted);
    append(found.outliers, more.outliers);
    append(found.jumps, more.jumps);
  }
  void operator()(const Measurement& measurement) {
    std::visit(Takes{[&](const CommandSample& command) { commands.push(command.sample); },
                     [&](const WheelSample& wheels) { wheels_known.push(wheels.sample); },
                     [&](const MeasuredPose& pose) { add(gate.push(pose, inputs())); }, [](const auto& /*other*/) {}},
               measurement);
  }
};

}  // namespace

void push(MotionLearner& learner, const Recording& run) {
  merge(run, [&](const Measurement& measurement) { learner.push(measurement); });
}

CutRuns cut_segments(const StreamSettings& settings, std::span<const Recording> runs) {
  SegmentStream stream = without_targets(settings);
  CutRuns cut;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    stream_run(stream, runs[i]);
    for (StreamItem& item : stream.take_items()) {
      if (auto* segment = std::get_if<DrivenSegment>(&item)) {
        cut.segments.push_back(std::move(*segment));
        cut.run.push_back(i);
      }
    }
    for (const Rejected& rejected : stream.take_rejected()) {
      cut.rejected.push_back(rejected);
      cut.rejected_run.push_back(i);
    }
  }
  return cut;
}

MotionEvidence motion_evidence(const StreamSettings& settings, std::span<const Recording> runs) {
  SegmentStream stream = without_targets(settings);
  for (const Recording& run : runs) {
    stream_run(stream, run);
    stream.take_items();
    stream.take_rejected();
  }
  return stream.evidence();
}

std::vector<std::vector<InputSample>> expected_commands(const StreamSettings& settings,
                                                        std::span<const Recording> runs) {
  SegmentStream stream = without_targets(settings);
  std::vector<std::vector<InputSample>> expected;
  for (const Recording& run : runs) {
    stream.start_run();
    auto& found = expected.emplace_back();
    merge(run, [&](const Measurement& measurement) {
      stream.push(measurement);
      if (const auto* command = std::get_if<CommandSample>(&measurement)) {  // what the stream's gates see of it
        const double t = command->sample.t;
        found.push_back({t, stream.drive().commands.held_at(t).value_or(BodyTwist{})});
      }
    });
    stream.end_run();
    stream.take_items();
    stream.take_rejected();
  }
  return expected;
}

GatedPoses gate_poses(const Recording& run, double unknown_after) {
  ToGate gate(unknown_after);
  merge(run, gate);
  gate.add(gate.gate.finish(gate.inputs()));
  return gate.found;
}

}  // namespace slipwise
