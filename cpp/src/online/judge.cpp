// SPDX-License-Identifier: Apache-2.0
// Targets are predicted by parameters of before, slip as the segments until then show it.
#include "slipwise/online/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "slipwise/filter/body_force.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/online/known_sources.hpp"
#include "slipwise/segment/input_spread.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

/// Driven by `other` inputs, where there are some.
Eigen::Vector3d pose_after(const MotionModel& model, const Eigen::VectorXd& mean, const DrivenSegment& driven,
                           const std::optional<InputHistory>& other = std::nullopt) {
  const SegmentPath path = integrate_segment(model, mean, other ? *other : driven.inputs, driven.segment);
  return chart_of(path.directions(), path.rows());
}

}  // namespace

std::shared_ptr<const MotionPosterior> motion_amid(const Knowledge& known, const Segment& segment,
                                                   const LearnerSettings& settings) {
  const BodyForce force(known.motion->model.basis(), settings.hypotheses.filter.force);
  if (!force.learned() || !std::isfinite(known.until)) {
    return known.motion;
  }
  MotionPosterior later = *known.motion;
  const double amid = 0.5 * (segment.start + segment.end);
  const double spoken = known.until - 0.5 * settings.stream.segment_length;  // the middle of the last segment
  force.pass(later.estimate, std::max(amid - spoken, 0.0));
  return std::make_shared<const MotionPosterior>(std::move(later));
}

HeldOutPrediction judged(const TargetSegment& target, const LearnerSettings& settings, RecentKnowledge& recent,
                         HeldOutErrors& errors, const LearnerLog& log) {
  const double horizon = settings.stream.horizons[target.horizon];
  const double age = settings.stream.age_of_known(horizon);
  const Knowledge& known = recent.at(target.driven.segment.start - age);
  const DrivenSegment driven =
      known.sources ? measured_by(*known.sources, target, known.motion->noise_scale) : target.driven;
  const Segment& segment = driven.segment;
  const SegmentList before = recent.segments_before(segment.start);
  const SlipNow& slip = recent.slip_after(*known.disturbance, known.motion, before);
  auto [expected, nominal] = known.disturbance->predict_both(*motion_amid(known, segment, settings), slip, driven);
  const Rows measured = rows_of(segment.measured);
  const Directions directions = directions_of(segment.measured);
  const Structure structure = known.motion->structure;
  const HorizonErrors::Known earlier = errors.before(target.horizon, segment.start - age);
  const StudentT student = earlier.students[static_cast<std::size_t>(structure)];
  const double as_three = 3.0 / static_cast<double>(measured.size());  // rows, whose errors are known by three
  const RowsCovariance of_inputs =
      input_covariance(known.motion->model, known.motion->estimate.mean, driven, target.spread);
  expected.covariance += of_inputs / student.inflation;  // which does not grow them: they are of no errors so far
  nominal.covariance += of_inputs / student.inflation;
  const double squared =
      as_three * normalised_square(shorter_error(directions, measured, expected.pose), expected.covariance);
  const double nominal_squared =
      as_three * normalised_square(shorter_error(directions, measured, nominal.pose), nominal.covariance);
  errors.of(target.horizon).learn(driven.known_at, structure, squared, nominal_squared, horizon + age);
  const Knowledge& after = recent.at(segment.end);
  const double last = before.empty() ? -std::numeric_limits<double>::infinity() : before.back()->known_at;
  const double used = std::max({known.until, last, earlier.until});
  const bool at_start = segment.initial || settings.stream.car;  // what the drive did then was measured
  return {.run = log.run(),
          .horizon = target.horizon,
          .start = log.clock().stamp(segment.start),
          .end = log.clock().stamp(segment.end),
          .pose = chart_of(directions, expected.pose),
          .covariance = student.inflation * chart_covariance(directions, expected.covariance),
          .student = student,
          .nominal_nis = nominal_squared,
          .structure = structure,
          .measured = chart_of(directions, measured),
          .baseline = pose_after(MotionModel(), Eigen::VectorXd(0), driven, target.baseline),
          .in_sample = pose_after(after.motion->model, after.motion->estimate.mean, driven),
          .learned_until = log.clock().stamp(at_start ? segment.start : std::min(used, segment.start))};
}

}  // namespace slipwise
