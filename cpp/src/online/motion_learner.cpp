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

namespace slipwise {
namespace {

constexpr double kPieces = 12.0;   // that it takes to learn a segment, or so
constexpr double kMostPieces = 8;  // that a push learns of what waits, unless they are due
constexpr int kSlices = 2;         // of refits that a push does beside what waits: some 100 us each
constexpr double kNever = std::numeric_limits<double>::infinity();

std::size_t index(Structure structure) { return static_cast<std::size_t>(structure); }

const MotionModel& baseline_model() {
  static const MotionModel model({"none", {}, {}, {}}, {});
  return model;
}

/// Driven by `other` inputs, where there are some.
Eigen::Vector3d pose_after(const MotionModel& model, const Eigen::VectorXd& mean, const DrivenSegment& driven,
                           const std::optional<InputHistory>& other = std::nullopt) {
  const SegmentPath path = integrate_segment(model, mean, other ? *other : driven.inputs, driven.segment);
  return chart_of(path.directions(), path.rows());
}

DisturbanceFilter disturbance_of(const LearnerSettings& settings) {
  return settings.learn_disturbance ? DisturbanceFilter(settings.disturbance) : DisturbanceFilter(DisturbanceModel{});
}

/// Of the knowledge before that one, nothing is asked [s].
double longest_back(const StreamSettings& settings) {
  double longest = kRecent * settings.segment_length;
  for (const double horizon : settings.horizons) {
    longest = std::max(longest, 2.0 * horizon + std::max(horizon, settings.age_of_known(horizon)));
  }
  return longest;
}

double known_at(const StreamItem& item) {
  return std::visit(Takes{[](const WheelSegment& wheels) { return wheels.known_at; },
                          [](const TwistSegment& twists) { return twists.driven.known_at; },
                          [](const DrivenSegment& segment) { return segment.known_at; },
                          [](const auto& other) { return other.driven.known_at; }},
                    item);
}

}  // namespace

MotionLearner::MotionLearner(const LearnerSettings& settings)
    : settings_(settings),
      stream_(settings.stream),
      hypotheses_(settings.hypotheses),
      disturbance_(disturbance_of(settings)),
      localizer_(pose_filter_settings(settings)),
      errors_(settings.stream.horizons),
      before_run_(-kNever),
      sources_(settings.stream, settings.hypotheses.filter) {
  known_ = RecentKnowledge(now_known(-kNever), settings.learn_disturbance, kRecent * settings.stream.segment_length,
                           longest_back(settings.stream));
}

void MotionLearner::start_run() {
  end_run();
  before_run_ = std::max(before_run_, stream_.newest());
  stream_.start_run();
  known_.start_run();
  localizer_.restart();
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
    known_.restart_clock();
    errors_.restart_clock();
    before_run_ = -kNever;
  }
  return clock_.counted(stamp);
}

void MotionLearner::push(const Measurement& measurement) {
  Measurement sample = measurement;
  double& t = stamp_of(sample);
  t = counted(t);
  const double before = stream_.newest();
  const bool taken = stream_.push(sample);
  const auto* pose = std::get_if<MeasuredPose>(&sample);
  if (pose != nullptr && taken && !pose->position && pose->source == 0) {
    localizer_.push(*pose);
  }
  take_in();
  if (std::holds_alternative<CommandSample>(sample) || std::holds_alternative<WheelSample>(sample) ||
      std::holds_alternative<Tilt>(sample)) {
    localizer_.forget_without(t);
  }
  int pieces = pieces_now(stream_.newest() - before);
  while (pieces-- > 0 && work()) {
  }
  for (int slice = 0; slice < kSlices && hypotheses_.refit_slice(); ++slice) {
  }
}

/// Of what waits, so that it is learned evenly until it is due, where `passed` [s] lie between the stamps of pushes.
int MotionLearner::pieces_now(double passed) const {
  if (waiting_.empty() || !(passed > 0.0) || std::isinf(passed)) {
    return 1;
  }
  const double left = known_at(waiting_.front()) + kReady - stream_.newest();
  double pieces = 0.0;
  for (const StreamItem& item : waiting_) {
    const bool is_segment = std::holds_alternative<DrivenSegment>(item) || std::holds_alternative<SlipSegment>(item);
    pieces += is_segment ? kPieces : 1.0;
  }
  return static_cast<int>(std::ceil(std::clamp(pieces * passed / std::max(left, passed), 1.0, kMostPieces)));
}

/// Takes over what the stream has complete. What should have been learned by now is learned at once, so that results
/// do not depend on how many pushes there were meanwhile.
void MotionLearner::take_in() {
  for (StreamItem& item : stream_.take_items()) {
    waiting_.push_back(std::move(item));
  }
  for (const Rejected& rejected : stream_.take_rejected()) {
    reject(rejected);
  }
  work_until(stream_.newest() - kReady);
}

/// One bounded piece; whether there is more.
bool MotionLearner::work() {
  if (waiting_.empty()) {
    if (settings_.learn_disturbance) {  // so that a prediction need not find out where slip is now
      const Knowledge& known = known_.at(stream_.newest() - kReady);
      known_.slip_after(*known.disturbance, known.motion, known_.segments_before(stream_.newest()));
    }
    return false;
  }
  if (std::holds_alternative<SourceSegment>(waiting_.front())) {
    learn_source();
    return !waiting_.empty();
  }
  started_ = learn_front();
  if (!started_) {
    waiting_.pop_front();
  }
  return !waiting_.empty();
}

/// A piece of what waits longest; whether there is more of it.
bool MotionLearner::learn_front() {
  return std::visit(Takes{[&](WheelSegment& wheels) {
                            hypotheses_.learn_actuator(wheels);
                            limits_.keep_wheels(std::move(wheels));
                            return false;
                          },
                          [&](TwistSegment& twists) {
                            limits_.keep_twists(std::move(twists.driven));
                            return false;
                          },
                          [&](const SlipSegment& slip) {
                            if (!started_) {
                              hypotheses_.start_slip(slip.driven);
                              return true;
                            }
                            const bool more = hypotheses_.advance_slip();
                            if (!more) {
                              consider_surfaces(slip.driven.segment.end);
                            }
                            return more;
                          },
                          [&](const TargetSegment& target) {
                            judge(target);
                            return false;
                          },
                          [](const SourceSegment& /*of another source*/) { return false; },
                          [&](const DrivenSegment& segment) {
                            if (!started_) {
                              learn_disturbance(segment);
                              hypotheses_.start(segment, stream_.wheels_known());
                              return true;
                            }
                            const bool more = hypotheses_.advance();
                            if (!more) {
                              consider_surfaces(segment.segment.end);
                              publish(segment);
                            }
                            return more;
                          }},
                    waiting_.front());
}

void MotionLearner::work_until(double t) {
  while (!waiting_.empty() && !later(known_at(waiting_.front()), t)) {
    work();
  }
}

void MotionLearner::work_through() {
  while (work()) {
  }
}

/// How slip differs now is learned about what was known before the segment, from the segments before it: how late they
/// came says nothing of slip.
void MotionLearner::learn_disturbance(const DrivenSegment& segment) {
  if (settings_.learn_disturbance) {
    const auto& before = known_.newest().slip;
    const SlipNow& slip = known_.slip_after(disturbance_, before, known_.segments_until(segment.segment.start));
    disturbance_.learn(*before, slip, segment);
    hypotheses_.expect_lasting(disturbance_.law());
  }
}

void MotionLearner::publish(const DrivenSegment& segment) {
  known_.publish(now_known(segment.known_at), segment);
  if (settings_.stream.from_commands) {
    limits_.keep(segment);
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
  const bool alarm = event.updates[index(known_.newest().slip->structure)].change.alarm;
  log_.say(event, clock_);
  if (alarm) {
    log_.say({.kind = LearnerEvent::Kind::TerrainChange, .run = runs_, .t = segment.segment.end}, clock_);
  }
  if (refitted) {
    log_.say({.kind = LearnerEvent::Kind::Refit, .run = runs_, .t = segment.segment.end}, clock_);
  }
}

/// Predicts a target from what was known before it, then holds it against what was measured.
void MotionLearner::judge(const TargetSegment& target) {
  const double horizon = settings_.stream.horizons[target.horizon];
  const double age = settings_.stream.age_of_known(horizon);
  const Knowledge& known = known_.at(target.driven.segment.start - age);
  const DrivenSegment driven =
      known.sources ? measured_by(*known.sources, target, known.motion->noise_scale) : target.driven;
  const Segment& segment = driven.segment;
  const SegmentList recent = known_.segments_before(segment.start);
  const SlipNow& slip = known_.slip_after(*known.disturbance, known.motion, recent);
  auto [expected, nominal] = known.disturbance->predict_both(*aged(known, segment), slip, driven);
  const Rows measured = rows_of(segment.measured);
  const Directions directions = directions_of(segment.measured);
  const Structure structure = known.motion->structure;
  const HorizonErrors::Known earlier = errors_.before(target.horizon, segment.start - age);
  const StudentT student = earlier.students[index(structure)];
  const double as_three = 3.0 / static_cast<double>(measured.size());  // rows, whose errors are known by three
  const RowsCovariance of_inputs =
      input_covariance(known.motion->model, known.motion->estimate.mean, driven, target.spread);
  expected.covariance += of_inputs / student.inflation;  // which does not grow them: they are of no errors so far
  nominal.covariance += of_inputs / student.inflation;
  const double squared =
      as_three * normalised_square(shorter_error(directions, measured, expected.pose), expected.covariance);
  const double nominal_squared =
      as_three * normalised_square(shorter_error(directions, measured, nominal.pose), nominal.covariance);
  errors_.of(target.horizon).learn(driven.known_at, structure, squared, nominal_squared, horizon + age);
  const Knowledge& after = known_.at(segment.end);
  const double used = std::max({known.until, recent.empty() ? -kNever : recent.back()->known_at, earlier.until});
  const bool at_start = segment.initial || settings_.stream.car;  // what the drive did then was measured
  const auto prediction = std::make_shared<const HeldOutPrediction>(
      HeldOutPrediction{.run = runs_,
                        .horizon = target.horizon,
                        .start = clock_.stamp(segment.start),
                        .end = clock_.stamp(segment.end),
                        .pose = chart_of(directions, expected.pose),
                        .covariance = student.inflation * chart_covariance(directions, expected.covariance),
                        .student = student,
                        .nominal_nis = nominal_squared,
                        .structure = structure,
                        .measured = chart_of(directions, measured),
                        .baseline = pose_after(baseline_model(), Eigen::VectorXd(0), driven, target.baseline),
                        .in_sample = pose_after(after.motion->model, after.motion->estimate.mean, driven),
                        .learned_until = clock_.stamp(at_start ? segment.start : std::min(used, segment.start))});
  errors_.keep(prediction);
  log_.say({.kind = LearnerEvent::Kind::HeldOut, .run = runs_, .t = segment.end, .prediction = prediction}, clock_);
}

/// Counts and says what was rejected.
void MotionLearner::reject(const Rejected& rejected) {
  log_.count(rejected.stream, rejected.reason);
  log_.say({.kind = LearnerEvent::Kind::Rejected,
            .run = runs_,
            .t = rejected.t,
            .stream = rejected.stream,
            .reason = rejected.reason},
           clock_);
}

}  // namespace slipwise
