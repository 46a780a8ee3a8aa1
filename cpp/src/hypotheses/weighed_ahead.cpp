// SPDX-License-Identifier: Apache-2.0
// Bases and structures weighed by what they predict over a horizon (derivations/averaging.md).
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "slipwise/filter/weighting.hpp"
#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/linear/tuning.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kAheadPatience, 0.3);  // learning rate of structures over that of bases, of predictions over a horizon

const MotionModel& baseline_model() {
  static const MotionModel model({"none", {}, {}, {}}, {});
  return model;
}

/// Of each basis, and of their average, which is the last.
std::vector<Rows> errors_of(const MotionModel& model, const CandidateMeans& means, const DrivenSegment& driven) {
  const Directions directions = directions_of(driven.segment.measured);
  const Rows measured = rows_of(driven.segment.measured);
  std::vector<Rows> errors;
  for (Eigen::Index i = 0; i <= means.by_basis.cols(); ++i) {
    const Eigen::VectorXd mean = i < means.by_basis.cols() ? Eigen::VectorXd(means.by_basis.col(i)) : means.mean;
    const SegmentPath path = integrate_segment(model, mean, driven.inputs, driven.segment);
    errors.push_back(shorter_error(directions, measured, path.rows()));
  }
  return errors;
}

Eigen::VectorXd scores_of(const std::vector<Rows>& errors, const RowsCovariance& covariance) {
  Eigen::VectorXd scores(std::ssize(errors));
  std::ranges::transform(errors, scores.begin(), [&](const Rows& error) {
    return student_log_score(normalised_square(error, covariance), covariance);
  });
  return scores;
}

BasisErrors lengths_of(const std::vector<Rows>& errors) {
  BasisErrors lengths{Eigen::VectorXd(std::ssize(errors)), Eigen::VectorXd(std::ssize(errors))};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    lengths.position[static_cast<Eigen::Index>(i)] = errors[i].head(2).norm();
    lengths.heading[static_cast<Eigen::Index>(i)] = std::abs(errors[i][2]);
  }
  return lengths;
}

}  // namespace

const MotionModel& MotionHypotheses::model_of(Structure structure) const {
  switch (structure) {
    case Structure::Joint:
      return joint_.model();
    case Structure::Direct:
      return present(direct_).model();
    case Structure::Cascaded:
      return present(cascaded_).posterior()->model;
    default:
      return baseline_model();
  }
}

std::vector<CandidateMeans> MotionHypotheses::candidates() const {
  std::vector<CandidateMeans> found;
  for (const Structure structure : tried_.keys()) {
    const auto posterior = of(structure);
    CandidateMeans means{structure, posterior->estimate.mean, {}};
    if (structure == Structure::Cascaded) {
      means.by_basis = present(cascaded_).means();
    } else if (structure != Structure::Baseline) {
      means.by_basis = (structure == Structure::Joint ? joint_ : present(direct_)).means();
    }
    found.push_back(std::move(means));
  }
  return found;
}

std::optional<BasisErrors> MotionHypotheses::weigh(const std::vector<CandidateMeans>& then, Structure predicts,
                                                   const DrivenSegment& driven, const RowsCovariance& covariance) {
  std::optional<BasisErrors> found;
  Eigen::VectorXd of_structures(tried_.size());
  std::size_t known = 0;
  for (std::size_t place = 0; place < tried_.size(); ++place) {
    const auto means = std::ranges::find(then, tried_[place], &CandidateMeans::structure);
    if (means == then.end() || means->mean.size() != model_of(tried_[place]).size() ||
        means->by_basis.rows() != (means->by_basis.cols() > 0 ? means->mean.size() : 0)) {
      continue;  // it was not tried then
    }
    const std::vector<Rows> errors = errors_of(model_of(tried_[place]), *means, driven);
    const Eigen::VectorXd scores = scores_of(errors, covariance);
    of_structures[static_cast<Eigen::Index>(place)] = scores[scores.size() - 1];
    ++known;
    if (ModelAverage* average = slip_of(tried_[place]); average != nullptr && scores.size() > 2) {
      average->weigh(scores.head(scores.size() - 1));
    }
    if (tried_[place] == predicts && errors.size() > 2 && errors.front().size() == 3) {
      found = lengths_of(errors);
    }
  }
  if (known == tried_.size() && known > 1) {
    tried_.sharpen(settings_.average.weighting.ahead_rate * kAheadPatience * of_structures);
    drop_refuted();
  }
  return found;
}

/// What learns the slip of a structure; none of the baseline.
ModelAverage* MotionHypotheses::slip_of(Structure structure) {
  return structure == Structure::Cascaded && cascaded_ ? &cascaded_->slip() : average_of(structure);
}

}  // namespace slipwise
