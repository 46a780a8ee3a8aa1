// SPDX-License-Identifier: Apache-2.0
// A logarithmic pool of two experts, and a logistic judgement of what is unknown.
#include "slipwise/terrain/expert_pool.hpp"

#include <stdexcept>

#include "slipwise/linear/softmax.hpp"

namespace slipwise {
namespace {

constexpr double kLeastShare = 0.01;  // of an expert's probability: no expert may rule a surface out alone
constexpr double kCertain = 1e-6;     // probabilities beyond this have no log odds of their own
constexpr double kFarthest = 50.0;    // log odds

}  // namespace

Eigen::MatrixXd ExpertPool::pooled(const Eigen::Ref<const Eigen::MatrixXd>& by_vibration,
                                   const Eigen::Ref<const Eigen::MatrixXd>& by_current) const {
  if (by_vibration.rows() != by_current.rows() || by_vibration.cols() != by_current.cols()) {
    throw std::invalid_argument("the experts of a pool answer for as many windows and surfaces each");
  }
  Eigen::ArrayXXd logs = Eigen::ArrayXXd::Zero(by_vibration.rows(), by_vibration.cols());
  if (vibration != 0.0) {
    logs += vibration * (by_vibration.array() + kLeastShare).log();
  }
  if (current != 0.0) {
    logs += current * (by_current.array() + kLeastShare).log();
  }
  return softmax_of_rows(logs.matrix());
}

Eigen::VectorXd doubt_of(const Eigen::Ref<const Eigen::MatrixXd>& probability) {
  Eigen::ArrayXd best = Eigen::ArrayXd::Zero(probability.rows());
  if (probability.cols() > 0) {
    best = probability.rowwise().maxCoeff();
  }
  best = best.max(kCertain).min(1.0 - kCertain);
  return ((1.0 - best) / best).log();
}

Eigen::VectorXd ExpertPool::unknown(const Eigen::Ref<const Eigen::MatrixXd>& probability,
                                    const Eigen::Ref<const Eigen::VectorXd>& newness_of) const {
  if (newness_of.size() != probability.rows()) {
    throw std::invalid_argument("each window has one newness");
  }
  const Eigen::ArrayXd score = offset + doubt * doubt_of(probability).array() + newness * newness_of.array();
  return 1.0 / (1.0 + (-score.max(-kFarthest).min(kFarthest)).exp());
}

}  // namespace slipwise
