// SPDX-License-Identifier: Apache-2.0
// What waits is learned piece by piece while measurements arrive; estimates are published at stamps, not at times.
#include "slipwise/online/segment_learner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>
#include <variant>

#include "slipwise/archive/bytes.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/behind_limits.hpp"
#include "slipwise/online/judge.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/sample_gate.hpp"
#include "slipwise/online/stamp_spacing.hpp"
#include "slipwise/online/student_t.hpp"

namespace slipwise {
namespace {

constexpr double kPieces = 12.0;   // that it takes to learn a segment, or so
constexpr double kMostPieces = 8;  // that a push learns of what waits, unless they are due
constexpr double kDone = 0.9;      // [s] after which it is learned, if pushes come until kReady or not
constexpr int kSlices = 2;         // of refits that a push does beside what waits: some 100 us each

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

/// Pieces of what waits to be done at once, so that it is learned evenly until it is due.
int pieces_now(const std::deque<StreamItem>& waiting, double newest, double passed) {
  if (waiting.empty() || !(passed > 0.0) || std::isinf(passed)) {
    return 1;
  }
  const double left = known_at(waiting.front()) + kDone - newest;
  double pieces = 0.0;
  for (const StreamItem& item : waiting) {
    const bool is_segment = std::holds_alternative<DrivenSegment>(item) || std::holds_alternative<SlipSegment>(item);
    pieces += is_segment ? kPieces : 1.0;
  }
  if (left <= passed) {  // the next push may come too late
    return static_cast<int>(pieces);
  }
  return static_cast<int>(std::ceil(std::clamp(pieces * passed / left, 1.0, kMostPieces)));
}

/// Variance of a Student t over that of the normal with its scale.
double spread(const StudentT& student) { return student.inflation * student.dof / std::max(student.dof - 2.0, 1.0); }

}  // namespace

SegmentLearner::SegmentLearner(const LearnerSettings& settings)
    : settings_(settings),
      hypotheses_(settings.hypotheses),
      disturbance_(disturbance_of(settings)),
      errors_(settings.stream.horizons),
      targets_(settings.stream.horizons.size()),
      sources_(settings.stream, settings.hypotheses.filter) {
  known_ = RecentKnowledge(now_known(-kNever), settings.learn_disturbance, kRecent * settings.stream.segment_length,
                           longest_back(settings.stream));
}

void SegmentLearner::start_run() {
  known_.start_run();
  hypotheses_.start_run();
  sources_.start_run();
}

/// At the end of a run no better source can come any more.
void SegmentLearner::end_run(const SegmentStream& stream) {
  work_through(stream);
  if (settings_.stream.sources.empty()) {
    return;
  }
  for (DrivenSegment& segment : sources_.finish()) {
    segment.known_at = std::max(segment.known_at, stream.newest());
    waiting_.emplace_back(std::move(segment));
  }
  work_through(stream);
}

void SegmentLearner::restart_clock() {
  known_.restart_clock();
  errors_.restart_clock();
}

void SegmentLearner::take_in(SegmentStream& stream) {
  for (StreamItem& item : stream.take_items()) {
    waiting_.push_back(std::move(item));
  }
  for (const Rejected& rejected : stream.take_rejected()) {
    log_.reject(rejected);
  }
  work_until(stream, stream.newest() - kReady);
}

void SegmentLearner::work_evenly(const SegmentStream& stream, double passed) {
  int pieces = pieces_now(waiting_, stream.newest(), passed);
  while (pieces-- > 0 && work(stream)) {
  }
  for (int slice = 0; slice < kSlices && hypotheses_.structures().refit_slice(); ++slice) {
  }
}

void SegmentLearner::work_until(const SegmentStream& stream, double t) {
  while (!waiting_.empty() && !later(known_at(waiting_.front()), t)) {
    work(stream);
  }
}

void SegmentLearner::work_through(const SegmentStream& stream) {
  while (work(stream)) {
  }
}

/// One bounded piece; whether there is more.
bool SegmentLearner::work(const SegmentStream& stream) {
  if (waiting_.empty()) {
    if (settings_.learn_disturbance) {  // so that a prediction need not find out where slip is now
      const Knowledge& known = known_.at(stream.newest() - kReady);
      known_.slip_after(*known.disturbance, known.motion, known_.segments_before(stream.newest()));
    }
    return false;
  }
  if (std::holds_alternative<SourceSegment>(waiting_.front())) {
    learn_source();
    return !waiting_.empty();
  }
  started_ = learn_front(stream);
  if (!started_) {
    waiting_.pop_front();
  }
  return !waiting_.empty();
}

/// A piece of what waits longest; whether there is more of it.
bool SegmentLearner::learn_front(const SegmentStream& stream) {
  CascadedModel* const cascade = hypotheses_.structures().cascaded();
  return std::visit(
      Takes{[&](WheelSegment& wheels) {
              if (cascade != nullptr) {
                cascade->learn_actuator(wheels);
              }
              limits_.keep_wheels(std::move(wheels));
              return false;
            },
            [&](TwistSegment& twists) {
              limits_.keep_twists(std::move(twists.driven));
              return false;
            },
            [&](const SlipSegment& slip) {
              if (!started_ && cascade != nullptr) {
                cascade->start_slip(slip.driven);
                return true;
              }
              const bool more = cascade != nullptr && cascade->advance_slip();
              if (!more) {
                consider_surfaces(slip.driven.segment.end);
              }
              return more;
            },
            [&](TargetSegment& target) {
              const auto prediction =
                  std::make_shared<const HeldOutPrediction>(judged(target, settings_, known_, errors_, log_));
              errors_.keep(prediction);
              log_.say({.kind = LearnerEvent::Kind::HeldOut, .t = target.driven.segment.end, .prediction = prediction});
              if (!settings_.stream.car) {
                targets_.keep(target.horizon, std::move(target.driven));
              }
              return false;
            },
            [](const SourceSegment& /*of another source*/) { return false; },
            [&](const DrivenSegment& segment) {
              if (!started_) {
                learn_disturbance(segment);
                hypotheses_.start(segment, stream.wheels_known());
                return true;
              }
              const bool more = hypotheses_.advance();
              if (!more) {
                consider_surfaces(segment.segment.end);
                publish(segment, stream.wheel_interval());
              }
              return more;
            }},
      waiting_.front());
}

/// By the present estimate of the slip: where the baseline predicts best, by the best model that has some.
void SegmentLearner::learn_source() {
  auto item = std::get<SourceSegment>(std::move(waiting_.front()));
  waiting_.pop_front();
  const double start = item.driven.segment.start;
  KnownSources::Found found = sources_.see(*known_.newest().slip, std::move(item));
  if (found.poor) {
    log_.reject({Stream::Pose, Reason::PoorPose, start});
  }
  waiting_.insert(waiting_.begin(), std::make_move_iterator(found.learned.begin()),
                  std::make_move_iterator(found.learned.end()));
}

/// How slip differs now is learned about what was known before the segment, from the segments before it: how late they
/// came says nothing of slip.
void SegmentLearner::learn_disturbance(const DrivenSegment& segment) {
  if (settings_.learn_disturbance) {
    const auto& before = known_.newest().slip;
    const SlipNow& slip = known_.slip_after(disturbance_, before, known_.segments_until(segment.segment.start));
    disturbance_.learn(*before, slip, segment);
    hypotheses_.structures().take(SlipLasts{correlation_time(disturbance_.law(), kUsualCorrelationTime)});
  }
}

void SegmentLearner::publish(const DrivenSegment& segment, double wheel_interval) {
  known_.publish(now_known(segment.known_at), segment);
  if (settings_.stream.from_commands) {
    limits_.keep(segment);
  }
  const double end = segment.segment.end;
  seconds_ += end - segment.segment.start;
  LearnerEvent event{.kind = LearnerEvent::Kind::SegmentLearned, .t = end};
  event.updates = hypotheses_.updates();
  event.weights = hypotheses_.structures().weights();
  event.surfaces = hypotheses_.bank().probabilities();
  for (std::size_t i = 0; i < kStructures; ++i) {
    event.posteriors[i] =
        supported(hypotheses_.structures().of(static_cast<Structure>(i)), wheel_interval, hypotheses_.count());
  }
  const bool refitted = std::ranges::any_of(event.updates, &StructureUpdate::refitted);
  const auto present = static_cast<std::size_t>(known_.newest().slip->structure);
  const bool alarm = event.updates[present].change.alarm;
  log_.say(std::move(event));
  if (alarm) {
    log_.say({.kind = LearnerEvent::Kind::TerrainChange, .t = end});
  }
  if (refitted) {
    log_.say({.kind = LearnerEvent::Kind::Refit, .t = end});
  }
}

void SegmentLearner::consider_surfaces(double t) {
  hypotheses_.bank().consider(learned_slip(hypotheses_.structures(), disturbance_.law()));
  note_surfaces(log_.run(), t);
}

void SegmentLearner::note_surfaces(std::size_t run, double t) { log_.say(hypotheses_.bank().take_events(), run, t); }

/// What is known now was changed beside segments, at `t` [s].
void SegmentLearner::note_change(std::size_t run, double t) {
  note_surfaces(run, t);
  known_.replace(now_known(known_.newest().until));
}

Knowledge SegmentLearner::now_known(double until) const {
  const Structures& structures = hypotheses_.structures();
  const auto motion = structures.posterior();  // what predicts best may count the lateness of poses as a delay
  return {
      .until = until,
      .motion = motion,
      .slip = motion->structure == Structure::Baseline ? structures.slip_posterior() : motion,
      .disturbance = std::make_shared<const DisturbanceFilter>(disturbance_),
      .clock = motion->model.learned().clock_offset ? motion : structures.of(Structure::Cascaded),
      .sources = settings_.stream.sources.empty() ? nullptr : std::make_shared<const SourceNoise>(sources_.noise())};
}

void SegmentLearner::change(const SegmentStream& stream,
                            const std::function<void(MotionHypotheses&, const DisturbanceModel&)>& change) {
  work_through(stream);
  change(hypotheses_, disturbance_.law());
  note_change(log_.run(), stream.newest());
}

void SegmentLearner::start_drive(const DriveStart& start, std::size_t run, double ended) {
  hypotheses_.start_drive(disturbance_.law(), start);
  note_change(run, ended);
}

void SegmentLearner::begin_with(const SegmentStream& stream, const KnownBefore& known, const DisturbanceModel& law,
                                bool wheels) {
  hypotheses_.begin_with(known, settings_.stream.segment_length, wheels);
  if (settings_.learn_disturbance) {
    disturbance_.begin_with(law);
  }
  note_change(log_.run(), stream.newest());
}

std::vector<std::string> SegmentLearner::add_surfaces(const SegmentStream& stream, const KnownBefore& other) {
  std::vector<std::string> names = hypotheses_.add_surfaces(disturbance_.law(), other);
  note_surfaces(log_.run(), stream.newest());
  return names;
}

LegKnowledge SegmentLearner::for_leg(double t, double horizon) {
  const Knowledge& known = known_.at(t - kReady);
  return {.posterior = known.motion,
          .disturbance = known.disturbance,
          .slip = known_.slip_after(*known.disturbance, known.motion, known_.segments_before(t - kReady)),
          .inflation = spread(errors_.student(t, horizon, known.motion->structure))};
}

/// Segments that are complete with all that was pushed, and not learned yet.
std::vector<DrivenSegment> SegmentLearner::complete_now(const SegmentStream& stream) const {
  std::vector<DrivenSegment> complete;
  for (const StreamItem& item : waiting_) {
    if (const auto* segment = std::get_if<DrivenSegment>(&item)) {
      complete.push_back(*segment);
    }
    if (const auto* source = std::get_if<SourceSegment>(&item); source != nullptr && source->source == 0) {
      complete.push_back(source->driven);
    }
  }
  std::ranges::move(sources_.waiting(), std::back_inserter(complete));
  for (DrivenSegment& segment : stream.pending_segments()) {
    complete.push_back(std::move(segment));
  }
  const double since = stream.newest() - kRecent * settings_.stream.segment_length;
  std::erase_if(complete, [&](const DrivenSegment& each) { return !later(each.segment.start, since); });
  return complete;
}

SlipNow SegmentLearner::slip_at_newest(const SegmentStream& stream, const Knowledge& known,
                                       const CommandLimits& limits) {
  std::vector<DrivenSegment> complete =
      settings_.learn_disturbance ? complete_now(stream) : std::vector<DrivenSegment>{};
  SegmentList recent = known_.segments_before(stream.newest());
  std::vector<DrivenSegment> limited;
  if (!unlimited(limits)) {
    limited.reserve(recent.size());
    for (const DrivenSegment*& each : recent) {
      each = &limited.emplace_back(behind(*each, limits));
    }
    std::ranges::transform(complete, complete.begin(), [&](const DrivenSegment& each) { return behind(each, limits); });
  }
  SlipNow slip = known_.slip_after(*known.disturbance, known.motion, recent);
  for (const DrivenSegment& segment : complete) {
    known.disturbance->follow(*known.motion, slip, segment);
  }
  return slip;
}

SurfaceBank SegmentLearner::surfaces() const {
  MotionHypotheses now = hypotheses_;
  now.bank().keep_present(learned_slip(now.structures(), disturbance_.law()));
  return now.bank();
}

std::optional<ActuatorLimits> SegmentLearner::find_limits(double wheel_separation) const {
  return limits_.find(hypotheses_.structures(), *known_.newest().motion, settings_.hypotheses, wheel_separation);
}

/// Against what a learner of the same settings begins with, and what a prediction looks up without asking.
void SegmentLearner::check_loaded(const SegmentLearner& made) const {
  hypotheses_.check_loaded(made.hypotheses_);
  sources_.check_loaded(made.sources_);
  known_.check_loaded(made.known_);
  errors_.check_loaded(settings_.stream.horizons);
  targets_.check_loaded(made.targets_);
  const std::size_t horizons = settings_.stream.horizons.size();
  const std::size_t classes = kPoseFixes * std::max<std::size_t>(1, settings_.stream.sources.size());
  const auto are_known = [&](const std::array<std::size_t, 2>& each) { return each[0] < classes && each[1] < classes; };
  const auto is_target = [&](const StreamItem& item) {
    const auto* target = std::get_if<TargetSegment>(&item);
    const auto* source = std::get_if<SourceSegment>(&item);
    return (target == nullptr || (target->horizon < horizons && are_known(target->classes))) &&
           (source == nullptr || (source->source < settings_.stream.sources.size() && are_known(source->classes)));
  };
  if (!std::ranges::all_of(waiting_, is_target)) {
    archive::refuse("malformed: its parts contradict each other");
  }
}

}  // namespace slipwise
