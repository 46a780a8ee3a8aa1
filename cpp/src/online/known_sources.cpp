// SPDX-License-Identifier: Apache-2.0
// A segment calibrates its source, shows how large its errors are, and is then merged with those of others.
#include "slipwise/online/known_sources.hpp"

#include <array>
#include <limits>
#include <utility>

#include "slipwise/filter/rows_of_positions.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kOpen, 0.25);          // of a segment's noise variances: what is not known of its source may be as much
constexpr double kLongestPart = 1.06;  // a segment may be longer than asked for by this factor

/// Gives sensors the noise of the source that they are of.
void set_noise(Segment& segment, const SourceNoise& noise, const std::array<std::size_t, 2>& classes,
               const Eigen::Vector3d& scale) {
  for (auto& [sensor, z] : segment.measured) {
    sensor.own_noise = !noise.is_reference(classes);
    if (sensor.own_noise) {
      sensor.noise_factor = noise.size(classes, scale);
    }
  }
}

}  // namespace

DrivenSegment measured_by(const SourceNoise& noise, const TargetSegment& target, const Eigen::Vector3d& scale) {
  DrivenSegment driven = target.driven;
  set_noise(driven.segment, noise, target.classes, scale);
  return driven;
}

KnownSources::KnownSources(const StreamSettings& stream, const CausalFilterSettings& filter)
    : settings_(stream.sources),
      filter_(filter),
      calibrations_(stream.sources.begin(), stream.sources.end()),
      noise_(filter.noise),
      merge_(stream.sources.size(), kLongestPart * stream.segment_length + 3.0 * kClocksApart),
      learned_(stream.sources.size(), 0) {
  start_run();
}

void KnownSources::start_run() {
  merge_.restart();
  seen_until_.assign(settings_.size(), -std::numeric_limits<double>::infinity());
}

/// What the errors of a segment show, which must not overlap with those seen before.
void KnownSources::look(const MotionPosterior& posterior, const DrivenSegment& driven, const SourceSegment& item) {
  DrivenSegment seen = driven;
  if (item.source > 0) {
    calibrations_[item.source].learn(posterior, driven, filter_.iekf);
    seen.segment = calibrations_[item.source].corrected(driven.segment);
  }
  if (item.classes[0] != item.classes[1]) {
    return;
  }
  noise_.meet(item.classes[0], posterior.noise_scale);
  const auto at = linearize_segment(posterior.model, posterior.estimate.mean, seen.inputs, seen.segment);
  const RowsCovariance open = at.by_parameter * posterior.estimate.covariance * at.by_parameter.transpose();
  const RowsCovariance expected = slip_covariance(at.path, posterior.noise) +
                                  at.path.measurement_noise(rows_of(seen.segment.measured), posterior.noise);
  const RowErrors shown{shorter_error_of(seen.segment, at).cwiseAbs2(), open.diagonal(), expected.diagonal()};
  noise_.learn(item.classes[0], at.path.directions(), alike_of_positions(seen.segment.measured, shown));
}

/// Puts the segment where and when it really was; false while too little is known of that.
bool KnownSources::calibrated(const MotionPosterior& posterior, DrivenSegment& driven,
                              const SourceSegment& item) const {
  if (item.source == 0) {
    return true;
  }
  const SourceCalibration& calibration = calibrations_[item.source];
  const Rows open = calibration.open(posterior, driven);
  driven.segment = calibration.corrected(driven.segment);
  const Eigen::Vector3d larger = chart_of(directions_of(driven.segment.measured), open);
  for (auto& [sensor, z] : driven.segment.measured) {
    sensor.noise_factor.array() *= 1.0 + larger.array();
  }
  return open.maxCoeff() <= kOpen;
}

KnownSources::Found KnownSources::see(const MotionPosterior& posterior, SourceSegment item) {
  DrivenSegment& driven = item.driven;
  const auto place = [&] { set_noise(driven.segment, noise_, item.classes, posterior.noise_scale); };
  place();
  if (!later(seen_until_[item.source], driven.segment.start)) {
    seen_until_[item.source] = driven.segment.end;
    look(posterior, driven, item);
    place();
  }
  const double beside = noise_.beside_best(item.classes);
  const double start = driven.segment.start;
  const double known_at = driven.known_at;
  const bool ready = calibrated(posterior, driven, item);
  const bool poor = beside > settings_[item.source].poorest && noise_.known(item.classes);
  merge_.see(item.source, std::min(start, driven.segment.start), beside);
  if (ready && !poor && noise_.known(item.classes)) {
    merge_.push({.driven = std::move(driven), .source = item.source, .noise = beside});
  }
  std::vector<DrivenSegment> learned = counted(merge_.take(known_at));
  for (DrivenSegment& each : learned) {
    each.known_at = known_at;
  }
  return {.learned = std::move(learned), .poor = poor};
}

std::vector<DrivenSegment> KnownSources::counted(std::vector<DrivenSegment> learned) {
  for (const DrivenSegment& each : learned) {
    ++learned_[source_number(each.segment)];
  }
  return learned;
}

std::vector<DrivenSegment> KnownSources::waiting() const {
  std::vector<DrivenSegment> found;
  for (const MergedSegment& each : merge_.waiting()) {
    if (each.source == 0) {
      found.push_back(each.driven);
    }
  }
  return found;
}

}  // namespace slipwise
