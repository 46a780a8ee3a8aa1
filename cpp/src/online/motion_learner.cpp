// SPDX-License-Identifier: Apache-2.0
// Segments are learned piece by piece while measurements arrive; estimates are published at stamps, not at times.
#include "slipwise/online/motion_learner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/lie/se2.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/sample_gate.hpp"
#include "slipwise/online/stamp_spacing.hpp"
#include "slipwise/online/student_t.hpp"
#include "slipwise/segment/input_spread.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/sensor_motion.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kMostWheelSegments = 200;    // in which limits are looked for
constexpr std::size_t kMostCommandSegments = 100;  // by which they are judged
constexpr int kSlices = 8;                         // of refits that a push may do where no segment waits: some 100 us
constexpr std::size_t kMostEvents = 10000;
constexpr double kNever = std::numeric_limits<double>::infinity();

std::size_t index(Structure structure) { return static_cast<std::size_t>(structure); }

const MotionModel& baseline_model() {
  static const MotionModel model({"none", {}, {}, {}}, {});
  return model;
}

/// Driven by `other` inputs, where there are some.
Eigen::Vector3d pose_after(const MotionModel& model, const Eigen::VectorXd& mean, const DrivenSegment& driven,
                           const std::optional<InputHistory>& other = std::nullopt) {
  return integrate_segment(model, mean, other ? *other : driven.inputs, driven.segment).sensor_motion().vector();
}

void keep(std::deque<WheelSegment>& kept, WheelSegment&& segment) {
  kept.push_back(std::move(segment));
  if (kept.size() > kMostWheelSegments) {
    kept.pop_front();
  }
}

DisturbanceFilter disturbance_of(const LearnerSettings& settings) {
  return settings.learn_disturbance ? DisturbanceFilter(settings.disturbance) : DisturbanceFilter(DisturbanceModel{});
}

}  // namespace

MotionLearner::MotionLearner(const LearnerSettings& settings)
    : settings_(settings),
      stream_(settings.stream),
      hypotheses_(settings.hypotheses),
      disturbance_(disturbance_of(settings)),
      pose_filter_(pose_filter_settings(settings)),
      monitor_(pose_filter_settings(settings).nominal, settings.stream.rules.late_factor),
      errors_(settings.stream.horizons.size()),
      held_out_(settings.stream.horizons.size()),
      before_run_(-kNever),
      sources_(settings.stream, settings.hypotheses.filter) {
  known_.push_back(now_known(-kNever));
}

void MotionLearner::start_run() {
  end_run();
  before_run_ = std::max(before_run_, stream_.newest());
  stream_.start_run();
  recent_.clear();
  recent_slip_.restart();
  pose_filter_.restart();
  monitor_.restart();
  hypotheses_.start_run();
  sources_.start_run();
  runs_ += run_begins_ ? 0 : 1;
  run_begins_ = true;
}

void MotionLearner::end_run() {
  stream_.end_run();
  take_in();
  work_through();
  finish_sources();
}

MotionLearner MotionLearner::completed() const {
  MotionLearner complete = *this;
  complete.end_run();
  return complete;
}

/// A stamp as all of them are counted here. Where those of a run begin before those of the last one ended, the clock
/// was set again: all is known by then.
double MotionLearner::counted(double stamp) {
  if (!run_begins_ || !(std::abs(stamp) <= kLatestStamp)) {
    return clock_.counted(stamp);
  }
  run_begins_ = false;
  const bool first = before_run_ == -kNever;
  const bool set_again = later(before_run_, clock_.counted(stamp));
  if (first || set_again) {
    clock_.start_at(stamp);
    stream_.count_from(clock_.stamp(0.0));
  }
  if (set_again) {
    for (Knowledge& known : known_) {
      known.until = -kNever;
    }
    known_.erase(known_.begin(), known_.end() - 1);
    std::ranges::for_each(errors_, &HorizonErrors::restart_clock);
    before_run_ = -kNever;
  }
  return clock_.counted(stamp);
}

void MotionLearner::push_command(double t, const BodyTwist& twist) {
  t = counted(t);
  stream_.push_command({t, twist});
  take_in();
  pose_filter_.forget_without(t);
  work();
}

void MotionLearner::push_wheels(double t, const BodyTwist& twist) {
  t = counted(t);
  stream_.push_wheels({t, twist});
  take_in();
  pose_filter_.forget_without(t);
  work();
}

void MotionLearner::push_attitude(double t, double roll, double pitch) {
  t = counted(t);
  if (const auto tilt = stream_.push_attitude({t, roll, pitch})) {
    steepest_ = std::max({steepest_, std::abs(tilt->roll), std::abs(tilt->pitch)});
  }
  take_in();
  pose_filter_.forget_without(t);
  work();
}

void MotionLearner::push(const Measurement& measurement) {
  std::visit(Takes{[&](const CommandSample& command) { push_command(command.sample.t, command.sample.twist); },
                   [&](const WheelSample& wheels) { push_wheels(wheels.sample.t, wheels.sample.twist); },
                   [&](const KnownForce& known) { push_force(known); },
                   [&](const Tilt& tilt) { push_attitude(tilt.t, tilt.roll, tilt.pitch); },
                   [&](const MeasuredPose& pose) { push_pose(pose); },
                   [&](const YawRate& sample) { push_gyro(sample.t, sample.rate); }},
             measurement);
}

void MotionLearner::push_force(const KnownForce& known) {
  KnownForce force = known;
  force.t = counted(force.t);
  stream_.push_force(force);
  take_in();
  work();
}

void MotionLearner::push_gyro(double t, double rate) {
  t = counted(t);
  stream_.push_gyro({t, rate});
  take_in();
  work();
}

void MotionLearner::push_pose(const MeasuredPose& measured, bool learned) {
  MeasuredPose pose = measured;
  pose.t = counted(pose.t);
  if (stream_.push_pose(pose, learned) && !pose.position && pose.source == 0) {
    pose_filter_.push(pose);
    monitor_.push(pose);
  }
  take_in();
  work();
}

/// Takes over what the stream has complete. What should have been learned by now is learned at once, so that results
/// do not depend on how many pushes there were meanwhile.
void MotionLearner::take_in() {
  for (StreamItem& item : stream_.take_items()) {
    waiting_.push_back(std::move(item));
  }
  for (const Rejected& rejected : stream_.take_rejected()) {
    count(rejected);
  }
  work_until(stream_.newest() - kReady);
}

/// One bounded piece; whether there is more.
bool MotionLearner::work() {
  if (waiting_.empty()) {
    prepare_prediction();
    for (int slice = 0; slice < kSlices && hypotheses_.refit_slice(); ++slice) {
    }
    return false;
  }
  bool more = false;
  if (auto* wheels = std::get_if<WheelSegment>(&waiting_.front())) {
    hypotheses_.learn_actuator(*wheels);
    keep(wheel_segments_, std::move(*wheels));
  } else if (auto* twists = std::get_if<TwistSegment>(&waiting_.front())) {
    keep(twist_segments_, std::move(twists->driven));
  } else if (const auto* slip = std::get_if<SlipSegment>(&waiting_.front())) {
    if (!started_) {
      hypotheses_.start_slip(slip->driven);
    }
    more = !started_ || hypotheses_.advance_slip();
    if (!more) {
      consider_surfaces(slip->driven.segment.end);
    }
  } else if (const auto* target = std::get_if<TargetSegment>(&waiting_.front())) {
    judge(*target);
  } else if (std::holds_alternative<SourceSegment>(waiting_.front())) {
    learn_source();
    return !waiting_.empty();
  } else {
    const auto& segment = std::get<DrivenSegment>(waiting_.front());
    if (started_) {
      more = hypotheses_.advance();
      if (!more) {
        consider_surfaces(segment.segment.end);
        publish(segment);
      }
    } else {
      learn_disturbance(segment);
      hypotheses_.start(segment, stream_.wheels_known());
      more = true;
    }
  }
  started_ = more;
  if (!more) {
    waiting_.pop_front();
  }
  return !waiting_.empty();
}

/// So that a prediction need not find out where slip is now.
void MotionLearner::prepare_prediction() {
  if (settings_.learn_disturbance) {
    const Knowledge& known = known_at(stream_.newest() - kReady);
    recent_slip_.after(*known.disturbance, known.motion, recent_before(stream_.newest()));
  }
}

void MotionLearner::work_until(double t) {
  const auto known_at = [](const StreamItem& item) {
    if (const auto* wheels = std::get_if<WheelSegment>(&item)) {
      return wheels->end;
    }
    if (const auto* twists = std::get_if<TwistSegment>(&item)) {
      return twists->driven.end;
    }
    if (const auto* slip = std::get_if<SlipSegment>(&item)) {
      return slip->driven.known_at;
    }
    if (const auto* source = std::get_if<SourceSegment>(&item)) {
      return source->driven.known_at;
    }
    const auto* target = std::get_if<TargetSegment>(&item);
    return target != nullptr ? target->driven.known_at : std::get<DrivenSegment>(item).known_at;
  };
  while (!waiting_.empty() && !later(known_at(waiting_.front()), t)) {
    work();
  }
}

void MotionLearner::work_through() {
  while (work()) {
  }
}

/// How slip differs now is learned about what was known before the segment.
void MotionLearner::learn_disturbance(const DrivenSegment& segment) {
  if (settings_.learn_disturbance) {
    const auto& before = known_.back().slip;
    const SlipNow& slip = recent_slip_.after(disturbance_, before, recent_before(segment.segment.start));
    disturbance_.learn(*before, slip, segment);
  }
}

void MotionLearner::publish(const DrivenSegment& segment) {
  known_.push_back(now_known(segment.known_at));
  double longest = kRecent * settings_.stream.segment_length;
  for (const double horizon : settings_.stream.horizons) {
    longest = std::max(longest, 3.0 * horizon);
  }
  while (known_.size() > 2 && known_[1].until < segment.known_at - longest) {
    known_.pop_front();
  }
  recent_.push_back(segment);
  while (recent_.front().segment.start < segment.segment.end - 2.0 * longest) {
    recent_.pop_front();
  }
  if (settings_.stream.from_commands) {
    command_segments_.push_back(segment);
  }
  if (command_segments_.size() > kMostCommandSegments) {
    command_segments_.pop_front();
  }
  seconds_ += segment.segment.end - segment.segment.start;
  LearnerEvent event{.kind = LearnerEvent::Kind::SegmentLearned, .run = runs_, .t = segment.segment.end};
  event.updates = hypotheses_.updates();
  event.weights = hypotheses_.weights();
  event.surfaces = hypotheses_.probable_surfaces();
  for (std::size_t i = 0; i < kStructures; ++i) {
    event.posteriors[i] =
        supported(hypotheses_.of(static_cast<Structure>(i)), stream_.wheel_interval(), hypotheses_.count());
  }
  const bool refitted = std::ranges::any_of(event.updates, &StructureUpdate::refitted);
  const bool alarm = event.updates[index(known_.back().slip->structure)].change.alarm;
  say(event);
  if (alarm) {
    say({.kind = LearnerEvent::Kind::TerrainChange, .run = runs_, .t = segment.segment.end});
  }
  if (refitted) {
    say({.kind = LearnerEvent::Kind::Refit, .run = runs_, .t = segment.segment.end});
  }
}

/// Predicts a target from what was known before it, then holds it against what was measured.
void MotionLearner::judge(const TargetSegment& target) {
  const double horizon = settings_.stream.horizons[target.horizon];
  const Knowledge& known = known_at(target.driven.segment.start - std::max(horizon, kReady));
  const DrivenSegment driven =
      known.sources ? measured_by(*known.sources, target, known.motion->noise_scale) : target.driven;
  const Segment& segment = driven.segment;
  const SegmentList recent = recent_before(segment.start);
  const SlipNow& slip = recent_slip_.after(*known.disturbance, known.motion, recent);
  auto [expected, nominal] = known.disturbance->predict_both(*aged(known, segment), slip, driven);
  const Eigen::Vector3d measured = segment.measured.vector();
  const Structure structure = known.motion->structure;
  HorizonErrors& errors = errors_[target.horizon];
  const HorizonErrors::Known earlier = errors.before(segment.start - std::max(horizon, kReady));
  const StudentT student = earlier.students[index(structure)];
  const double directions = settings_.stream.heading_only ? 3.0 : 1.0;  // one is measured in place of three
  const Eigen::Matrix3d of_inputs =
      input_covariance(known.motion->model, known.motion->estimate.mean, driven, target.spread);
  expected.covariance += of_inputs / student.inflation;  // which does not grow them: they are of no errors so far
  nominal.covariance += of_inputs / student.inflation;
  const double squared = directions * normalised_square(chart_error(measured, expected.pose), expected.covariance);
  const double nominal_squared =
      directions * normalised_square(chart_error(measured, nominal.pose), nominal.covariance);
  errors.learn(driven.known_at, structure, squared, nominal_squared);
  const Knowledge& after = known_at(segment.end);
  const double used = std::max({known.until, recent.empty() ? -kNever : recent.back()->known_at, earlier.until});
  const bool at_start = segment.initial || settings_.stream.car;  // what the drive did then was measured
  const auto prediction = std::make_shared<const HeldOutPrediction>(
      HeldOutPrediction{.run = runs_,
                        .horizon = target.horizon,
                        .start = clock_.stamp(segment.start),
                        .end = clock_.stamp(segment.end),
                        .pose = expected.pose,
                        .covariance = student.inflation * expected.covariance,
                        .student = student,
                        .nominal_nis = nominal_squared,
                        .structure = structure,
                        .measured = measured,
                        .baseline = pose_after(baseline_model(), Eigen::VectorXd(0), driven, target.baseline),
                        .in_sample = pose_after(after.motion->model, after.motion->estimate.mean, driven),
                        .learned_until = clock_.stamp(at_start ? segment.start : std::min(used, segment.start))});
  held_out_[target.horizon].keep(prediction);
  say({.kind = LearnerEvent::Kind::HeldOut, .run = runs_, .t = segment.end, .prediction = prediction});
}

void MotionLearner::count(const Rejected& rejected) {
  ++rejected_[static_cast<std::size_t>(rejected.stream)][static_cast<std::size_t>(rejected.reason)];
  say({.kind = LearnerEvent::Kind::Rejected,
       .run = runs_,
       .t = rejected.t,
       .stream = rejected.stream,
       .reason = rejected.reason});
}

/// Its stamp is as counted here.
void MotionLearner::say(LearnerEvent event) {
  event.t = clock_.stamp(event.t);
  events_.push_back(std::move(event));
  if (events_.size() > kMostEvents) {
    events_.pop_front();
    ++dropped_events_;
  }
}

std::vector<LearnerEvent> MotionLearner::events() {
  std::vector<LearnerEvent> all(std::make_move_iterator(events_.begin()), std::make_move_iterator(events_.end()));
  events_.clear();
  return all;
}

}  // namespace slipwise
