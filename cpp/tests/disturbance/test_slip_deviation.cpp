// SPDX-License-Identifier: Apache-2.0
// How far slip is from what was learned: nothing is known at first, segments move it, time lets it decay.
#include <doctest/doctest.h>

#include <cmath>

#include "slipwise/disturbance/slip_deviation.hpp"

namespace slipwise {
namespace {

const MotionModel& sample_motion() {
  static const MotionModel model(named_basis("edd-2"), {});
  return model;
}

const SlipDisturbance kLaw{.linear = 0.5, .angular = 0.5, .time_constant = 10.0};

DisturbedTerms terms() {
  return disturbed_terms(sample_motion(), Eigen::VectorXd::Constant(sample_motion().size(), 0.2));
}

/// Shows the first deviation in x alone.
ObservedSlip observed(double start, double innovation, double std) {
  ObservedSlip result{.start = start,
                      .end = start + 1e-6,
                      .innovation = Eigen::Vector3d(innovation, 0.0, 0.0),
                      .noise = std * std * Eigen::Matrix3d::Identity(),
                      .by_deviation = ObservedSlip::ByDeviation::Zero(3, terms().size())};
  result.by_deviation(0, 0) = 1.0;
  return result;
}

TEST_CASE("before any segment the deviation has its nominal variance") {
  REQUIRE(terms().size() > 0);
  const SlipDeviation deviation(kLaw, terms());
  const auto [mean, covariance] = deviation.mean_over(0.0, 1e-9);
  CHECK(mean.norm() == 0.0);
  CHECK(covariance(0, 0) == doctest::Approx(0.1 * 0.1));
}

TEST_CASE("a segment moves it as one observation of a Gaussian does") {
  SlipDeviation deviation(kLaw, terms());
  deviation.follow(observed(5.0, 0.06, 0.1));
  const auto [mean, covariance] = deviation.mean_over(5.0, 5.0 + 1e-9);
  CHECK(mean[0] == doctest::Approx(0.03).epsilon(1e-5));  // prior and noise are equally sure
  CHECK(covariance(0, 0) == doctest::Approx(0.005).epsilon(1e-5));
}

TEST_CASE("what was observed is forgotten by the time constant, towards the nominal variance") {
  SlipDeviation deviation(kLaw, terms());
  deviation.follow(observed(0.0, 0.06, 0.1));
  const auto [mean, covariance] = deviation.mean_over(10.0, 10.0 + 1e-9);
  CHECK(mean[0] == doctest::Approx(0.03 * std::exp(-1.0)).epsilon(1e-5));
  CHECK(covariance(0, 0) == doctest::Approx(0.01 - 0.005 * std::exp(-2.0)).epsilon(1e-5));
  const auto [late, nominal] = deviation.mean_over(1000.0, 1000.0 + 1e-9);
  CHECK(std::abs(late[0]) < 1e-9);
  CHECK(nominal(0, 0) == doctest::Approx(0.01));
}

TEST_CASE("the mean over a long time varies less than the deviation at one moment") {
  const SlipDeviation deviation(kLaw, terms());
  CHECK(deviation.mean_over(0.0, 100.0).second(0, 0) < 0.25 * deviation.mean_over(0.0, 0.1).second(0, 0));
}

TEST_CASE("an outlier moves it no further than the edge of what is credible does") {
  const auto moved = [](double innovation) {
    SlipDeviation deviation(kLaw, terms());
    deviation.follow(observed(0.0, innovation, 0.1));
    return deviation.mean_over(0.0, 1e-9).first[0];
  };
  const double edge = std::sqrt(16.266 * 0.02);  // sigma of the innovation times the gate
  CHECK(moved(edge) == doctest::Approx(edge / 2.0).epsilon(1e-3));
  CHECK(moved(100.0 * edge) < moved(edge));
  CHECK(moved(100.0 * edge) > 0.0);
}

}  // namespace
}  // namespace slipwise
