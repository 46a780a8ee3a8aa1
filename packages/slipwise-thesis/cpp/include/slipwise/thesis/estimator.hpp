// SPDX-License-Identifier: Apache-2.0
// One interface to all estimators, and the estimators by name.
#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "slipwise/thesis/batch_estimator.hpp"
#include "slipwise/thesis/delayed_state.hpp"
#include "slipwise/thesis/ekf_thesis.hpp"
#include "slipwise/thesis/gradient_descent.hpp"
#include "slipwise/thesis/iekf_estimator.hpp"

namespace slipwise {

/// What an estimator is: it learns segments in the order of time, and reports its posterior.
template <typename T>
concept SegmentEstimator =
    std::copyable<T> && requires(T estimator, const T& known, const InputHistory& inputs, const Segment& segment,
                                 const Eigen::VectorXd& std, const Eigen::Vector3d& scale) {
      { estimator.learn(inputs, segment) } -> std::same_as<IekfUpdate>;
      { known.estimate() } -> std::same_as<Estimate>;
      { known.model() } -> std::same_as<const MotionModel&>;
      // The same data under another slip prior; false where that cannot be done.
      { estimator.change_prior(std, std) } -> std::same_as<bool>;
      estimator.scale_noise(scale);  // factor of the noise variances of (x, y, theta)
    };

/// Any of the estimators, as a value.
class Estimator {
 public:
  template <SegmentEstimator T>
    requires(!std::same_as<T, Estimator>)
  explicit Estimator(T estimator) : estimator_(std::move(estimator)) {}

  IekfUpdate learn(const InputHistory& inputs, const Segment& segment) {
    return std::visit([&](auto& e) { return e.learn(inputs, segment); }, estimator_);
  }
  Estimate estimate() const {
    return std::visit([](const auto& e) { return e.estimate(); }, estimator_);
  }
  /// What learning goes on from: the estimate itself, unless that is a fit over all segments at once.
  Estimate running() const {
    return std::visit(
        [](const auto& e) {
          if constexpr (requires { e.running(); }) {
            return e.running();
          } else {
            return e.estimate();
          }
        },
        estimator_);
  }
  const MotionModel& model() const {
    return std::visit([](const auto& e) -> const MotionModel& { return e.model(); }, estimator_);
  }
  bool change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std) {
    return std::visit([&](auto& e) { return e.change_prior(old_std, new_std); }, estimator_);
  }
  void scale_noise(const Eigen::Vector3d& scale) {
    std::visit([&](auto& e) { e.scale_noise(scale); }, estimator_);
  }

 private:
  std::variant<GradientDescent, EkfThesis, IekfEstimator, DelayedState, BatchEstimator> estimator_;
};

/// Names that make_estimator knows.
std::vector<std::string> estimator_names();
/// True for those that the thesis feeds with overlapping segments at 20 Hz.
bool learns_overlapping_segments(std::string_view name);
/// \throws std::invalid_argument naming the known estimators, or when the prior does not fit the model.
Estimator make_estimator(std::string_view name, const MotionModel& model, const Estimate& prior,
                         const EstimatorSettings& settings);

}  // namespace slipwise
