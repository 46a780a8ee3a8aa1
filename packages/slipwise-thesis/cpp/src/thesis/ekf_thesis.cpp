// SPDX-License-Identifier: Apache-2.0
// Table 6.1, line by line. Errata that change nothing but the letters are corrected in the comments.
#include "slipwise/thesis/ekf_thesis.hpp"

#include <optional>
#include <utility>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/filter/prior.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {

EkfThesis::EkfThesis(MotionModel model, Estimate prior, const EstimatorSettings& settings)
    : model_(std::move(model)),
      settings_(settings.ekf_thesis),
      noise_(settings.noise),
      estimate_(std::move(prior)),
      prior_variance_(estimate_.covariance.diagonal()) {}

IekfUpdate EkfThesis::learn(const InputHistory& inputs, const Segment& segment) {
  // Input. Erratum: p_t stands there for p_{t-1}.
  // 1. p_t = p_{t-1}: (6.13) with G_t = I of size m; erratum of (6.14): it says 5.
  const auto at = linearize_segment(model_, estimate_.mean, inputs, segment);
  // 2. Erratum: the table writes R for the process noise and Q for that of the measurement; the text means the
  // opposite.
  Eigen::MatrixXd covariance = estimate_.covariance;
  covariance.diagonal() += settings_.process_std * settings_.process_std * prior_variance_;
  // 3. The gain, with J of (6.7), whose heading coupling is missing (erratum), or the exact one.
  const auto jacobian = segment_jacobian(settings_.jacobian, model_, at, segment);
  const RowsCovariance noise = segment_noise(at.path, rows_of(segment.measured), noise_, Eigen::Vector3d::Ones());
  const RowsCovariance s = innovation_covariance(covariance, jacobian, noise);
  // 4. and 5. No iteration, no gate.
  const Rows residual = error_of(segment, at);
  estimate_.mean += linear_update(covariance, jacobian, noise) * residual;
  estimate_.covariance = covariance;
  return {.estimate = estimate_,
          .innovation = residual,
          .innovation_covariance = s,
          .nis = normalised_square(residual, s),
          .weight = 1.0,
          .status = Status::Converged};
}

bool EkfThesis::change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std) {
  std::optional<Estimate> changed = change_slip_prior(estimate_, old_std, new_std);
  if (!changed) {
    return false;
  }
  estimate_ = std::move(*changed);
  prior_variance_.head(new_std.size()) = new_std.cwiseAbs2();
  return true;
}

}  // namespace slipwise
