// SPDX-License-Identifier: Apache-2.0
// Thesis (6.7) as printed, against its formula; the exact derivative against differences; how far they are apart.
#include <doctest/doctest.h>

#include <algorithm>

#include "finite_difference.hpp"
#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/thesis/thesis_jacobian.hpp"

namespace slipwise {
namespace {

const Segment kSegment{.start = 0.3, .end = 5.3};

InputHistory forward_drive() { return tests::sampled(tests::sample_drives().front().twist, 0.0, 0.05, 120); }

/// Integral of Gamma(theta) U dt (6.7, 6.9, 6.11) by Simpson's rule over every held input.
Eigen::MatrixXd printed(const MotionModel& model, const SegmentPath& path) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, model.size());
  for (std::size_t k = 0; k < path.drive.size(); ++k) {
    const ActuatorStep& step = path.drive[k];
    const double v = step.forward / step.duration, w = step.turn / step.duration;
    const Eigen::VectorXd c = model.basis().linearize_features({.v = v, .omega = w}).value;
    Eigen::MatrixXd u = Eigen::MatrixXd::Zero(3, model.size());
    for (Eigen::Index i = 0; i < model.size(); ++i) {
      u(static_cast<Eigen::Index>(model.basis().channel(static_cast<std::size_t>(i))), i) = c[i];
    }
    for (const auto& [fraction, weight] : {std::pair{0.0, 1.0}, std::pair{0.5, 4.0}, std::pair{1.0, 1.0}}) {
      Eigen::Matrix3d gamma = Eigen::Matrix3d::Identity();
      gamma.topLeftCorner<2, 2>() = rotation(path.poses[k].theta + fraction * path.tangents[k].z());
      jacobian += gamma * u * (weight / 6.0 * step.duration);
    }
  }
  return jacobian;
}

TEST_CASE("the thesis's Jacobian is the integral of (6.7)") {
  for (const char* name : {"thesis-15", "odd-even-10"}) {
    const MotionModel model(named_basis(name), {});
    const auto at = linearize_segment(model, tests::sample_slip(model.basis(), 61), forward_drive(), kSegment);
    const Eigen::MatrixXd jacobian = segment_jacobian(SegmentJacobian::Thesis, model, at, kSegment);
    CHECK(tests::jacobian_error(jacobian, printed(model, at.path)) < 1e-8);
  }
}

TEST_CASE(
    "the exact Jacobian is the derivative, and the thesis's is not: it lacks what yaw slip does to the position") {
  const MotionModel model(named_basis("thesis-15"), {});
  const InputHistory inputs = forward_drive();
  const Eigen::VectorXd alpha = tests::sample_slip(model.basis(), 62, 0.05);
  const auto predict = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return integrate_segment(model, p, inputs, kSegment).poses.back().vector();
  };
  const Eigen::MatrixXd numeric = tests::finite_difference(predict, alpha, 0.02);
  const auto at = linearize_segment(model, alpha, inputs, kSegment);
  CHECK(tests::jacobian_error(segment_jacobian(SegmentJacobian::Exact, model, at, kSegment), numeric) <
        tests::kDerivativeTolerance);
  const Eigen::MatrixXd thesis = segment_jacobian(SegmentJacobian::Thesis, model, at, kSegment);
  const auto yaw = static_cast<Eigen::Index>(model.basis().begin(Channel::Ang));
  CHECK(thesis.topRightCorner(2, model.size() - yaw).isZero(0.0));
  CHECK(numeric.topRightCorner(2, model.size() - yaw).norm() > 1.0);
  CHECK(tests::jacobian_error(thesis.leftCols(yaw), numeric.leftCols(yaw)) < tests::kDerivativeTolerance);
}

}  // namespace
}  // namespace slipwise
