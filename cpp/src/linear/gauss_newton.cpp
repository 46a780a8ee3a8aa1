// SPDX-License-Identifier: Apache-2.0
// Steps over normal equations, and when they end.
#include "slipwise/linear/gauss_newton.hpp"

#include <algorithm>
#include <utility>

#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

/// Of the information's diagonal: it hardly slows the last steps, and bounds those that nothing tells of.
constexpr double kDamping = 1e-4;
constexpr double kLeastFraction = 1e-6;  // of a step: where none goes downhill, the best is one at working precision

}  // namespace

GaussNewton::GaussNewton(Eigen::VectorXd start, const DescentSettings& settings)
    : settings_(settings), candidate_(std::move(start)), best_(candidate_), over_(false) {}

bool GaussNewton::judge(double cost) {
  if (begun_ && !(cost <= cost_)) {
    fraction_ /= 2.0;
    converged_ = fraction_ < kLeastFraction;
    return false;
  }
  converged_ = begun_ && cost_ - cost <= worth();
  begun_ = true;
  fraction_ = 1.0;
  best_ = candidate_;
  cost_ = cost;
  return true;
}

void GaussNewton::propose(const NormalEquations& at_best) {
  over_ = converged_ || iterations_ >= settings_.iterations;
  if (over_) {
    return;
  }
  if (fraction_ == 1.0) {
    Eigen::MatrixXd damped = at_best.information;
    damped.diagonal() *= 1.0 + kDamping;
    step_ = Cholesky(damped).solve(at_best.gradient);
    step_ *= std::min(1.0, settings_.longest_step / step_.cwiseAbs().maxCoeff());
  }
  const Eigen::VectorXd step = fraction_ * step_;
  if (step.dot(2.0 * at_best.gradient - at_best.information * step) <= worth()) {
    converged_ = over_ = true;  // not even what a parabola predicts is worth a look
    return;
  }
  ++iterations_;
  candidate_ = best_ + step;
}

}  // namespace slipwise
