// SPDX-License-Identifier: Apache-2.0
// Streams merged by their stamps.
#include "slipwise/online/recording.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <variant>

namespace slipwise {
namespace {

/// Hands each measurement to `receiver`, in the order of the stamps.
template <typename Receiver>
void merge(const Recording& run, Receiver&& receiver) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  const auto stamp = [](const auto& samples, std::size_t i) { return i < samples.size() ? samples[i].t : kEnd; };
  std::size_t command = 0;
  std::size_t wheel = 0;
  std::size_t attitude = 0;
  std::size_t pose = 0;
  std::size_t gyro = 0;
  const std::size_t count =
      run.commands.size() + run.wheels.size() + run.attitudes.size() + run.poses.size() + run.gyro.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double t = std::min({stamp(run.commands, command), stamp(run.wheels, wheel), stamp(run.attitudes, attitude),
                               stamp(run.poses, pose), stamp(run.gyro, gyro)});
    if (stamp(run.commands, command) == t) {
      receiver.command(run.commands[command++]);
    } else if (stamp(run.wheels, wheel) == t) {
      receiver.wheels(run.wheels[wheel++]);
    } else if (stamp(run.attitudes, attitude) == t) {
      receiver.attitude(run.attitudes[attitude++]);
    } else if (stamp(run.poses, pose) == t) {
      receiver.pose(run.poses[pose++]);
    } else {
      receiver.gyro(run.gyro[gyro++]);
    }
  }
}

struct ToLearner {
  MotionLearner& learner;

  void command(const InputSample& sample) const { learner.push_command(sample.t, sample.twist); }
  void wheels(const InputSample& sample) const { learner.push_wheels(sample.t, sample.twist); }
  void attitude(const Attitude& tilt) const { learner.push_attitude(tilt.t, tilt.roll, tilt.pitch); }
  void pose(const MeasuredPose& measured) const { learner.push_pose(measured); }
  void gyro(const YawRate& sample) const { learner.push_gyro(sample.t, sample.rate); }
};

struct ToStream {
  SegmentStream& stream;

  void command(const InputSample& sample) const { stream.push_command(sample); }
  void wheels(const InputSample& sample) const { stream.push_wheels(sample); }
  void attitude(const Attitude& tilt) const { stream.push_attitude({tilt.t, tilt.roll, tilt.pitch}); }
  void pose(const MeasuredPose& measured) const { stream.push_pose(measured); }
  void gyro(const YawRate& sample) const { stream.push_gyro(sample); }
};

/// Looks at what the stream's gates see of each command.
struct ToExpected {
  SegmentStream& stream;
  std::vector<InputSample>& expected;

  void command(const InputSample& sample) const {
    stream.push_command(sample);
    expected.push_back({sample.t, stream.commands().held_at(sample.t).value_or(BodyTwist{})});
  }
  void wheels(const InputSample& sample) const { stream.push_wheels(sample); }
  void attitude(const Attitude& tilt) const { stream.push_attitude({tilt.t, tilt.roll, tilt.pitch}); }
  void pose(const MeasuredPose& measured) const { stream.push_pose(measured); }
  void gyro(const YawRate& sample) const { stream.push_gyro(sample); }
};

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
  void command(const InputSample& sample) { commands.push(sample); }
  void wheels(const InputSample& sample) { wheels_known.push(sample); }
  void attitude(const Attitude& /*tilt*/) const {}
  void gyro(const YawRate& /*sample*/) const {}
  void pose(const MeasuredPose& measured) { add(gate.push(measured, inputs())); }
};

}  // namespace

void push(MotionLearner& learner, const Recording& run) { merge(run, ToLearner{learner}); }

CutRuns cut_segments(const StreamSettings& settings, std::span<const Recording> runs) {
  SegmentStream stream(settings);
  CutRuns cut;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    stream.start_run();
    merge(runs[i], ToStream{stream});
    stream.end_run();
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
  SegmentStream stream(settings);
  for (const Recording& run : runs) {
    stream.start_run();
    merge(run, ToStream{stream});
    stream.end_run();
    stream.take_items();
    stream.take_rejected();
  }
  return stream.evidence();
}

std::vector<std::vector<InputSample>> expected_commands(const StreamSettings& settings,
                                                        std::span<const Recording> runs) {
  SegmentStream stream(settings);
  std::vector<std::vector<InputSample>> expected;
  for (const Recording& run : runs) {
    stream.start_run();
    merge(run, ToExpected{stream, expected.emplace_back()});
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
