// SPDX-License-Identifier: Apache-2.0
// Measurements go through the stream to what learns; what is asked is answered from both.
#include "slipwise/online/motion_learner.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "slipwise/actuator/measured_start.hpp"
#include "slipwise/filter/base_link_model.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/behind_limits.hpp"
#include "slipwise/online/judge.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/sample_gate.hpp"
#include "slipwise/online/stamp_spacing.hpp"
#include "slipwise/segment/input_spread.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

constexpr double kLongestHorizon = 3600.0;  // [s] horizon
constexpr double kFastestInput = 1e3;       // [m/s, rad/s]
constexpr std::size_t kPathPoses = 5;       // of a prediction
constexpr double kOffsets = 1.5;  // [s] states are kept for longer than streams are late: no clock offset is larger

void check(const std::vector<InputSample>& future, double horizon) {
  if (!(horizon > 0.0) || horizon > kLongestHorizon) {
    throw std::invalid_argument("the horizon must be positive and at most " + std::to_string(kLongestHorizon) +
                                " s, got " + std::to_string(horizon));
  }
  double before = -kNever;
  for (const auto& [t, twist] : future) {
    const double fastest = std::max({std::abs(twist.v), std::abs(twist.vy), std::abs(twist.omega)});
    if (!(t > before) || !std::isfinite(t) || !(fastest <= kFastestInput)) {
      throw std::invalid_argument("future inputs must be finite, in m/s and rad/s, and their stamps must increase");
    }
    before = t;
  }
}

/// The same of base_link, by the clock of the inputs.
MotionPosterior of_base_link(MotionPosterior posterior) {
  KnownModel body = of_base_link(posterior.model, posterior.estimate);
  posterior.model = std::move(body.model);
  posterior.estimate = std::move(body.estimate);
  posterior.prior_std.conservativeResize(posterior.model.size());
  return posterior;
}

/// The inputs behind the limits of a drive, whose twist may have been measured at the start.
InputHistory limited_ahead(const DrivenSegment& ahead, const ActuatorModel& actuator, const CommandLimits& limits) {
  const Segment& segment = ahead.segment;
  return segment.initial
             ? limited_inputs(ahead.inputs, limits, measured_start(actuator, segment.start, *segment.initial))
             : limited_inputs(ahead.inputs, limits);
}

/// The beginnings of what lies ahead, each pushed by what pushes it on the whole.
std::vector<SegmentLinearization> pushed_beginnings(const MotionPosterior& motion, const DrivenSegment& ahead,
                                                    const ForceBuffer& forces) {
  std::vector<SegmentLinearization> found;
  Segment part = ahead.segment;
  for (std::size_t i = 1; i <= kPathPoses; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kPathPoses);
    part.end = ahead.segment.start + share * (ahead.segment.end - ahead.segment.start);
    const KnownForce force = forces.mean(part.start, part.end).value_or(KnownForce{});
    part.gx = force.x;
    part.gy = force.y;
    found.push_back(linearize_segment(motion.model, motion.estimate.mean, ahead.inputs, part));
  }
  return found;
}

}  // namespace

MotionLearner::MotionLearner(const LearnerSettings& settings)
    : stream_(settings.stream), learner_(settings), localizer_(pose_filter_settings(settings)) {}
MotionLearner::MotionLearner(const MotionLearner&) = default;
MotionLearner::MotionLearner(MotionLearner&&) noexcept = default;
MotionLearner& MotionLearner::operator=(const MotionLearner&) = default;
MotionLearner& MotionLearner::operator=(MotionLearner&&) noexcept = default;
MotionLearner::~MotionLearner() = default;

void MotionLearner::start_run() {
  end_run();
  before_run_ = std::max(before_run_, stream_.newest());
  stream_.start_run();
  localizer_.restart();
  learner_.start_run();
  if (!run_begins_) {
    learner_.log().next_run();
  }
  run_begins_ = true;
}

void MotionLearner::end_run() {
  stream_.end_run();
  learner_.take_in(stream_);
  learner_.end_run(stream_);
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
    return clock().counted(stamp);
  }
  run_begins_ = false;
  const bool first = before_run_ == -kNever;
  const bool set_again = later(before_run_, clock().counted(stamp));
  if (first || set_again) {
    learner_.log().clock().start_at(stamp);
    stream_.count_from(clock().stamp(0.0));
  }
  if (set_again) {
    learner_.restart_clock();
    before_run_ = -kNever;
  }
  return clock().counted(stamp);
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
  learner_.take_in(stream_);
  if (std::holds_alternative<CommandSample>(sample) || std::holds_alternative<WheelSample>(sample) ||
      std::holds_alternative<Tilt>(sample)) {
    localizer_.forget_without(t);
  }
  learner_.work_evenly(stream_, stream_.newest() - before);
}

void MotionLearner::forget(double fraction) {
  if (!(fraction >= 0.0) || !(fraction <= 1.0)) {
    throw std::invalid_argument("what is forgotten is a fraction between 0 and 1, got " + std::to_string(fraction));
  }
  learner_.change(stream_, [fraction](MotionHypotheses& hypotheses, const DisturbanceModel& /*law*/) {
    hypotheses.structures().take(ForgetSlip{fraction});
  });
}

void MotionLearner::start_drive(const DriveStart& start) {
  end_run();
  const std::size_t run = learner_.log().run();
  const double ended = stream_.newest();
  start_run();
  learner_.start_drive(start, run, ended);
}

/// Without a memory there is nothing to recall, and slip may jump.
void MotionLearner::cue_surface(const std::string& label) {
  const bool remember = learner_.settings().hypotheses.average.surfaces.remember;
  if (!remember && !label.empty()) {
    return;
  }
  learner_.change(stream_, [&](MotionHypotheses& hypotheses, const DisturbanceModel& law) {
    if (remember) {
      hypotheses.bank().cue(learned_slip(hypotheses.structures(), law), label);
    } else {
      hypotheses.structures().take(ChangeExpected{});
    }
  });
}

void MotionLearner::cue_terrain(const TerrainAnswer& answer) {
  check_answer(answer);
  learner_.change(stream_, [&](MotionHypotheses& hypotheses, const DisturbanceModel& law) {
    hypotheses.bank().hear(learned_slip(hypotheses.structures(), law), answer);
  });
}

void MotionLearner::begin_with(const KnownBefore& known, const DisturbanceModel& law, bool wheels) {
  learner_.begin_with(stream_, known, law, wheels);
}

std::vector<std::string> MotionLearner::add_surfaces(const KnownBefore& other) {
  return learner_.add_surfaces(stream_, other);
}

SurfaceBank MotionLearner::surfaces() const { return completed().learner_.surfaces(); }

PredictedPath MotionLearner::predict(const std::vector<InputSample>& future, double horizon, double embargo,
                                     const KnownAhead& known) {
  check(future, horizon);
  const auto counted = [this](auto samples) {
    std::ranges::for_each(samples, [this](auto& sample) { sample.t = clock().counted(sample.t); });
    return samples;
  };
  const std::vector<InputSample> inputs = counted(future);
  if (stream_.newest() == -kNever) {
    throw std::invalid_argument("nothing was measured in this run yet: push measurements before a prediction");
  }
  learner_.work_until(stream_, stream_.newest() - kReady);
  Knowledge knowledge = learner_.known().at(stream_.newest() - std::max(embargo, kReady));
  const Structure structure = knowledge.motion->structure;  // whose errors are known
  DrivenSegment ahead = stream_.drive().ahead(stream_.over(stream_.newest(), stream_.newest() + horizon), inputs);
  ahead.segment.measured = measured_pose({});
  CommandLimits limits;
  if (known.limits != nullptr && known.limits->posterior != nullptr) {
    knowledge.motion = known.limits->posterior;
    limits = known.limits->search.drive.limits;
    ahead.inputs = limited_ahead(ahead, knowledge.motion->model.actuator(knowledge.motion->estimate.mean), limits);
  }
  const SlipNow slip = learner_.slip_at_newest(stream_, knowledge, limits);
  const MotionPosterior motion = of_base_link(*motion_amid(knowledge, ahead.segment, learner_.settings()));
  const auto beginnings =
      known.forces.empty()
          ? linearize_beginnings(motion.model, motion.estimate.mean, ahead.inputs, ahead.segment, kPathPoses)
          : pushed_beginnings(motion, ahead, stream_.drive().forces_ahead(stream_.newest(), counted(known.forces)));
  PredictedPath path{.start = stream_.newest(),
                     .t = {},
                     .poses = {},
                     .covariances = {},
                     .students = {},
                     .structure = knowledge.motion->structure};
  std::ranges::transform(beginnings, std::back_inserter(path.t),
                         [](const SegmentLinearization& part) { return part.path.times.back(); });
  path.t.back() = ahead.segment.end;
  const auto along = knowledge.disturbance->predict_along(motion, slip, beginnings, ahead.segment);
  const auto of_inputs =
      input_covariances(motion.model, motion.estimate.mean, ahead,
                        stream_.drive().spread_ahead(path.start, path.start + horizon, inputs), path.t);
  for (std::size_t i = 0; i < along.size(); ++i) {
    path.students.push_back(learner_.errors().student(stream_.newest(), path.t[i] - path.start, structure));
    path.poses.emplace_back(along[i].pose);
    path.covariances.emplace_back(path.students.back().inflation * along[i].covariance + of_inputs[i]);
  }
  path.start = clock().stamp(path.start);
  std::ranges::for_each(path.t, [this](double& t) { t = clock().stamp(t); });
  return path;
}

LearnedModel MotionLearner::model() const {
  const MotionLearner complete = completed();
  const SegmentLearner& learner = complete.learner_;
  const SegmentStream& stream = complete.stream_;
  const Knowledge& known = learner.known().newest();
  LearnedModel learned{.known = known,
                       .students = learner.errors().nominal(known.motion->structure),
                       .held_out = learner.errors().predictions(),
                       .weights = learner.hypotheses().structures().weights(),
                       .range = stream.range(),
                       .seconds = learner.seconds(),
                       .segments = learner.hypotheses().count(),
                       .rejected = learner.log().rejected(),
                       .car = stream.drive().car_curves(),
                       .evidence = stream.evidence(),
                       .targets = learner.targets()};
  learned.known.until = clock().stamp(learned.known.until);
  const double spacing = stream.wheel_interval();
  learned.known.motion = supported(learned.known.motion, spacing, learned.segments);
  learned.known.slip = supported(learned.known.slip, spacing, learned.segments);
  return learned;
}

std::optional<ActuatorLimits> MotionLearner::find_limits(double wheel_separation) const {
  if (learner_.settings().hypotheses.wheelbase > 0.0) {
    return std::nullopt;  // limits are of yaw rates, and this drive takes curvatures
  }
  return completed().learner_.find_limits(wheel_separation);
}

PoseFilterSettings pose_filter_settings(const LearnerSettings& settings) {
  const MotionNoise& shape = settings.hypotheses.filter.noise.shape;
  return {.nominal = {.xy = shape.pose_std_xy, .yaw = shape.pose_std_yaw},
          .late_factor = settings.stream.rules.late_factor,
          .keep = settings.stream.latency + kOffsets};
}

MotionNow MotionLearner::motion_now() {
  const auto leg = [this](const LegKnowledge& known, double start, double end) {
    return motion_leg(known, stream_.drive().stretch(stream_.over(start, end), leg_memory(*known.posterior)));
  };
  const auto clock = learner_.known().at(stream_.newest() - kReady).clock;
  return {.inputs = stream_.drive().inputs(),
          .newest = stream_.newest(),
          .latency = stream_.settings().latency,
          .learned = learner_.seconds(),
          .late = clock ? pose_lateness(*clock, stream_.wheel_interval()) : PoseLateness{},
          .at = [this](double t, double horizon) { return learner_.for_leg(t, horizon); },
          .leg = leg};
}

std::optional<Odometry> MotionLearner::odometry() {
  std::optional<Odometry> found = localizer_.odometry(motion_now());
  if (found) {
    found->t = clock().stamp(found->t);
  }
  return found;
}

MotionState MotionLearner::motion_monitor() {
  MotionState state = localizer_.monitor(motion_now());
  if (state.since) {
    state.since = clock().stamp(*state.since);
  }
  return state;
}

}  // namespace slipwise
