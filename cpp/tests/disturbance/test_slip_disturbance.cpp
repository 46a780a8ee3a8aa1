// SPDX-License-Identifier: Apache-2.0
// The slip disturbance: found where it does, followed, let go with time, and not invented where it does not.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "simulated_drive.hpp"
#include "slipwise/disturbance/slip_disturbance.hpp"
#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

constexpr std::ptrdiff_t kRecent = 12;
const MotionNoise kNoise{.pose_std_xy = 0.02, .pose_std_yaw = 0.02};

/// edd-2 (lon.V, ang.w), known but for what wanders.
MotionPosterior known_posterior(const MotionModel& model) {
  return {.model = model,
          .estimate = {Eigen::Vector2d(-0.1, -0.3), Eigen::Matrix2d::Zero()},
          .prior_std = Eigen::Vector2d(0.3, 0.3),
          .noise = kNoise,
          .noise_scale = Eigen::Vector3d::Ones()};
}

/// Segments of 1 s of a robot whose slip has these fractions of V and w.
template <typename SlipAt>
std::vector<Segment> drive(const MotionModel& model, const InputHistory& inputs, int count, SlipAt slip_at) {
  std::mt19937_64 random(7);
  std::vector<Segment> segments;
  for (int i = 0; i < count; ++i) {
    Segment segment{.start = 1.0 + i, .end = 2.0 + i};
    const Pose2 truth = integrate_segment(model, slip_at(i), inputs, segment).poses.back();
    const Eigen::Vector3d noise = tests::normal3(random).cwiseProduct(Eigen::Vector3d(0.028, 0.028, 0.028));
    segment.measured = measured_pose(Pose2::from_vector(truth.vector() + noise));
    segments.push_back(segment);
  }
  return segments;
}

std::span<const Segment> before(const std::vector<Segment>& segments, std::ptrdiff_t i) {
  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - kRecent);
  return std::span(segments).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(i - first));
}

std::vector<DrivenSegment> driven(const InputHistory& inputs, std::span<const Segment> segments) {
  std::vector<DrivenSegment> all;
  for (const Segment& segment : segments) {
    all.push_back({.inputs = inputs, .segment = segment});
  }
  return all;
}

ExpectedPose expected(const DisturbanceFilter& slip, const MotionPosterior& posterior, const InputHistory& inputs,
                      std::span<const Segment> recent, const Segment& segment) {
  return slip.predict(posterior, slip.now(posterior, driven(inputs, recent)), {.inputs = inputs, .segment = segment});
}

void learn(DisturbanceFilter& slip, const MotionPosterior& posterior, const InputHistory& inputs,
           const std::vector<Segment>& segments, std::ptrdiff_t i) {
  const SlipNow now = slip.now(posterior, driven(inputs, before(segments, i)));
  slip.learn(posterior, now, {.inputs = inputs, .segment = segments[static_cast<std::size_t>(i)]});
}

struct Followed {
  DisturbanceFilter slip;
  double error = 0.0;        ///< mean squared heading error with what the last segments say
  double plain_error = 0.0;  ///< without
  double nis = 0.0;          ///< mean over the second half
};

Followed follow(const MotionPosterior& posterior, const InputHistory& inputs, const std::vector<Segment>& segments) {
  Followed found{.slip = DisturbanceFilter(DisturbanceSettings{})};
  for (std::ptrdiff_t i = 0; i < std::ssize(segments); ++i) {
    const Segment& next = segments[static_cast<std::size_t>(i)];
    if (2 * i >= std::ssize(segments)) {
      const ExpectedPose with = expected(found.slip, posterior, inputs, before(segments, i), next);
      const ExpectedPose plain = expected(found.slip, posterior, inputs, {}, next);
      const Eigen::Vector3d error = rows_of(next.measured) - with.pose;
      found.error += std::pow(error.z(), 2);
      found.plain_error += std::pow(rows_of(next.measured)[2] - plain.pose[2], 2);
      found.nis += error.dot(Cholesky(with.covariance).solve(error)) * 2.0 / static_cast<double>(segments.size());
    }
    learn(found.slip, posterior, inputs, segments, i);
  }
  return found;
}

struct Setting {
  MotionModel model{named_basis("edd-2"), {}};
  std::mt19937_64 random{3};
  InputHistory inputs = tests::random_inputs(random, 420.0, 0.05);
};

TEST_CASE("slip that holds still is not said to disturbance, and predictions stay as they were") {
  const Setting s;
  const MotionPosterior posterior = known_posterior(s.model);
  const auto segments = drive(s.model, s.inputs, 300, [](int) { return Eigen::Vector2d(-0.1, -0.3); });
  const Followed found = follow(posterior, s.inputs, segments);
  CHECK(found.slip.law().weights[0] > 0.7);
  CHECK(found.error < 1.05 * found.plain_error);
  CHECK(found.nis == doctest::Approx(3.0).epsilon(0.2));
}

TEST_CASE("yaw the slip disturbance is found in its channel, followed and predicted better, with a true covariance") {
  const Setting s;
  const MotionPosterior posterior = known_posterior(s.model);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<double> disturbance{0.0};
  const double kept = std::exp(-1.0 / 20.0);
  for (int i = 1; i < 300; ++i) {
    disturbance.push_back(kept * disturbance.back() + std::sqrt(1.0 - kept * kept) * 0.09 * normal(random));
  }
  const auto segments = drive(s.model, s.inputs, 300, [&](int i) {
    return Eigen::Vector2d(-0.1, -0.3 + disturbance[static_cast<std::size_t>(i)]);
  });
  const Followed found = follow(posterior, s.inputs, segments);
  double turning = 0.0;
  for (std::size_t i = 0; i < found.slip.law().candidates.size(); ++i) {
    turning +=
        found.slip.law().candidates[i].angular > 0.0 ? found.slip.law().weights[static_cast<Eigen::Index>(i)] : 0.0;
  }
  CHECK(turning > 0.9);
  CHECK(found.error < 0.6 * found.plain_error);
  CHECK(found.nis > 2.0);
  CHECK(found.nis < 4.0);
}

TEST_CASE("what was observed is let go with time, and the covariance comes back to what is nominal") {
  const Setting s;
  const MotionPosterior posterior = known_posterior(s.model);
  const auto segments = drive(s.model, s.inputs, 12, [](int) { return Eigen::Vector2d(-0.1, -0.15); });
  const DisturbanceFilter slip(DisturbanceSettings{.fractions = {0.3}, .time_constants = {20.0}, .white = 1e-6});
  const std::vector<double> start{0.0}, v{1.0}, vy{0.0}, omega{0.5};
  const InputHistory steady(start, v, vy, omega);
  const auto shift = [&](double after) {
    const Segment segment{.start = 13.0 + after, .end = 14.0 + after};
    const ExpectedPose with = expected(slip, posterior, steady, segments, segment);
    const ExpectedPose without = expected(slip, posterior, steady, {}, segment);
    return std::pair(std::abs(with.pose.z() - without.pose.z()), with.covariance(2, 2) / without.covariance(2, 2));
  };
  CHECK(shift(0.0).first > 2.0 * shift(20.0).first);
  CHECK(shift(300.0).first < 1e-6);
  CHECK(shift(300.0).second == doctest::Approx(1.0).epsilon(1e-6));
}

TEST_CASE("a model without linear terms is predicted as it is") {
  const Setting s;
  const MotionModel plain(Basis("none", {}, {}, {}), {});
  const MotionPosterior posterior{
      plain, {Eigen::VectorXd(0), Eigen::MatrixXd(0, 0)}, Eigen::VectorXd(0), kNoise, Eigen::Vector3d::Ones()};
  const auto segments = drive(s.model, s.inputs, 13, [](int) { return Eigen::Vector2d(-0.1, -0.15); });
  DisturbanceFilter slip(DisturbanceSettings{});
  learn(slip, posterior, s.inputs, segments, 12);
  const auto at = linearize_segment(plain, Eigen::VectorXd(0), s.inputs, segments.back());
  CHECK(expected(slip, posterior, s.inputs, before(segments, 12), segments.back()).pose == at.predicted);
}

TEST_CASE(
    "a law that is read back predicts to the last bit as the one learned, and what is nominal is its covariance") {
  const Setting s;
  const MotionPosterior posterior = known_posterior(s.model);
  const auto segments = drive(s.model, s.inputs, 40, [](int i) { return Eigen::Vector2d(-0.1, i < 20 ? -0.3 : -0.2); });
  DisturbanceFilter slip(DisturbanceSettings{});
  for (std::ptrdiff_t i = 0; i < 39; ++i) {
    learn(slip, posterior, s.inputs, segments, i);
  }
  const DisturbanceFilter read(slip.law());
  for (const auto& recent : {before(segments, 39), std::span<const Segment>{}}) {
    const ExpectedPose one = expected(slip, posterior, s.inputs, recent, segments.back());
    const ExpectedPose other = expected(read, posterior, s.inputs, recent, segments.back());
    CHECK(one.pose == other.pose);
    CHECK(one.covariance == other.covariance);
  }
  const auto at = linearize_segment(s.model, posterior.estimate.mean, s.inputs, segments.back());
  const Eigen::MatrixXd over =
      covariance_over(s.model, posterior.estimate.covariance, slip.law(), posterior.prior_std, 1.0);
  const Eigen::Matrix3d stated = prediction_covariance(at, over, posterior.noise, posterior.noise_scale);
  const ExpectedPose nominal = expected(read, posterior, s.inputs, {}, segments.back());
  CHECK((nominal.covariance - stated).norm() < 1e-12 * stated.norm());
  CHECK(nominal.pose == at.predicted);
  CHECK_THROWS_AS(read.predict(posterior, SlipNow{}, {.inputs = s.inputs, .segment = segments.back()}),
                  std::invalid_argument);
}

TEST_CASE("the deviation that is expected is the one that moves a prediction") {
  const Setting s;
  const MotionPosterior posterior = known_posterior(s.model);
  const auto segments = drive(s.model, s.inputs, 20, [](int) { return Eigen::Vector2d(-0.1, -0.3); });
  DisturbanceFilter slip(DisturbanceSettings{});
  SlipNow now = slip.now(posterior, {});
  for (std::size_t i = 0; i < 19; ++i) {
    slip.follow(posterior, now, {.inputs = s.inputs, .segment = segments[i]});
  }
  const Segment& last = segments.back();
  const auto at = linearize_segment(s.model, posterior.estimate.mean, s.inputs, last);
  const ExpectedDeviation found = slip.deviation(posterior, now, {last.start, last.end});
  const ExpectedPose pose = slip.predict_at(posterior, now, at, last);
  const Eigen::MatrixXd h = at.by_parameter(Eigen::all, found.places);
  CHECK(found.mean.norm() > 1e-3);
  CHECK((at.predicted + h * found.mean - pose.pose).norm() < 1e-12);
  const Eigen::Matrix3d without =
      prediction_covariance(at, posterior.estimate.covariance, posterior.noise, posterior.noise_scale);
  CHECK((without + h * found.covariance * h.transpose() - pose.covariance).norm() < 1e-12);
}

TEST_CASE("sizes that are no sizes are refused") {
  CHECK_THROWS_AS(DisturbanceFilter(DisturbanceSettings{.fractions = {0.1, 0.0}}), std::invalid_argument);
  CHECK_THROWS_AS(DisturbanceFilter(DisturbanceSettings{.time_constants = {std::numeric_limits<double>::quiet_NaN()}}),
                  std::invalid_argument);
  CHECK_THROWS_AS(DisturbanceFilter(DisturbanceSettings{.fractions = {}}), std::invalid_argument);
  const SlipDisturbance one{0.1, 0.0, 5.0};
  CHECK_THROWS_AS(DisturbanceFilter(DisturbanceModel{{one}, Eigen::VectorXd::Constant(1, 0.5)}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
