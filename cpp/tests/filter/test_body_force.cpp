// SPDX-License-Identifier: Apache-2.0
// A force learned beside slip: its process, whether the filter is as sure of both as it should be, and that a drive
// which cannot tell them apart is not claimed to.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "simulated_drive.hpp"
#include "slipwise/filter/body_force.hpp"
#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/slip/force_terms.hpp"

namespace slipwise {
namespace {

const BodyForceSettings kLaw{.time_constant = 120.0, .std = 0.03, .turn_std = 0.03};
const ReferenceSpeeds kForceSpeeds{.v = 1.2, .omega = 0.7};
const MotionNoise kForceNoise{.psd_time = {2e-4, 2e-4, 4e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.005};

TEST_CASE("a force fades into its prior, slip stays") {
  const Basis basis = with_force(named_basis("edd-2"), ForceFrame::Body);
  const BodyForce force(basis, kLaw);
  REQUIRE(force.places().size() == 6);
  const auto size = static_cast<Eigen::Index>(basis.size());
  Estimate known{Eigen::VectorXd::Constant(size, 0.02), 1e-6 * Eigen::MatrixXd::Identity(size, size)};
  force.pass(known, 120.0);
  const Eigen::Index ahead = force.places().front();
  CHECK(known.mean[ahead] == doctest::Approx(0.02 * std::exp(-1.0)));
  CHECK(known.covariance(ahead, ahead) == doctest::Approx(1e-6 * std::exp(-2.0) + 0.0009 * (1.0 - std::exp(-2.0))));
  CHECK(known.mean[0] == 0.02);  // lon.V
  force.pass(known, -1.0);       // another run
  CHECK(known.mean[ahead] == 0.0);
  CHECK(std::sqrt(known.covariance(ahead, ahead)) == doctest::Approx(0.03));
  CHECK(Eigen::LLT<Eigen::MatrixXd>(known.covariance).info() == Eigen::Success);
}

TEST_CASE("no force is learned without a time constant, and an impossible law is refused") {
  const Basis basis = with_force(named_basis("edd-2"), ForceFrame::Body);
  CHECK_FALSE(BodyForce(basis, {}).learned());
  CHECK_FALSE(BodyForce(named_basis("edd-2"), kLaw).learned());
  CHECK_THROWS_AS(BodyForce(basis, {.time_constant = -1.0}), std::invalid_argument);
  CHECK_THROWS_AS(BodyForce(basis, {.time_constant = 1.0, .std = NAN}), std::invalid_argument);
}

/// Twists that are held for some seconds each, forwards and, where wanted, backwards.
InputHistory held_inputs(std::mt19937_64& random, double length, bool backwards) {
  std::uniform_real_distribution<double> speed(0.4, 1.6), yaw(-0.9, 0.9), sign(-1.0, 1.0);
  std::vector<double> t, v, vy, omega;
  for (double now = 0.0; now < length; now += 3.0) {
    t.push_back(now);
    v.push_back((backwards && sign(random) < 0.0 ? -1.0 : 1.0) * speed(random));
    vy.push_back(0.0);
    omega.push_back(yaw(random));
  }
  return {t, v, vy, omega};
}

struct ForceDrive {
  bool backwards = true;
  double force = 1.0;        ///< of the law's standard deviation
  double correlation = 0.0;  ///< of slip noise from one segment to the next
  std::uint64_t seed = 1;
  std::size_t segments = 150;
  double time_constant = kLaw.time_constant;
};

struct Outcome {
  Eigen::VectorXd error;       ///< learned minus true, slip then force
  Eigen::MatrixXd covariance;  ///< as it is reported
  Eigen::VectorXd ratio;       ///< of posterior and prior variances of the force
  Eigen::VectorXd found;       ///< the force
};

/// The motion along a path whose slip is off by the same all along, by as much as white noise adds up to.
Pose2 pushed(const SegmentPath& path, const Eigen::Vector3d& draw) {
  const double seconds = path.times.back() - path.times.front();
  Pose2 pose;
  for (std::size_t k = 0; k < path.tangents.size(); ++k) {
    Eigen::Vector3d tangent = path.tangents[k];
    for (Eigen::Index c = 0; c < 3; ++c) {
      tangent[c] +=
          std::sqrt(kForceNoise.psd_time[static_cast<std::size_t>(c)] / seconds) * path.drive[k].duration * draw[c];
    }
    pose = compose(pose, exp(tangent));
  }
  return pose;
}

/// Slip is drawn once, the force follows its law from segment to segment.
Outcome learned(const ForceDrive& drive) {
  const MotionModel model(with_force(named_basis("drive-5"), ForceFrame::Body), {});
  CausalFilterSettings settings;
  settings.noise.shape = kForceNoise;
  settings.force = kLaw;
  settings.force.time_constant = drive.time_constant;
  settings.iekf.huber = 1e9;
  CausalFilter filter(model, settings);
  const BodyForce process(model.basis(), kLaw);
  std::mt19937_64 random(drive.seed);
  const InputHistory inputs = held_inputs(random, 2.0 * static_cast<double>(drive.segments) + 3.0, drive.backwards);
  std::normal_distribution<double> normal;
  Estimate prior{Eigen::VectorXd::Zero(model.size()), Eigen::MatrixXd::Zero(model.size(), model.size())};
  process.pass(prior, -1.0);
  const auto& places = process.places();
  const Eigen::MatrixXd nominal = prior.covariance(places, places);
  const Eigen::MatrixXd root = covariance_root(nominal);
  const auto draw = [&](Eigen::Index size) {
    Eigen::VectorXd numbers(size);
    for (double& number : numbers) {
      number = normal(random);
    }
    return numbers;
  };
  Eigen::VectorXd truth = 0.05 * draw(model.size());
  truth(places) = drive.force * root * draw(std::ssize(places));
  Pose2 observed = tests::measured_pose({}, kForceNoise, random), pose;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < drive.segments; ++i) {
    const double keep = std::exp(-2.0 / kLaw.time_constant);
    const Eigen::VectorXd step = drive.force * std::sqrt(1.0 - keep * keep) * root * draw(std::ssize(places));
    truth(places) = keep * truth(places) + step;
    Segment segment{.start = 0.5 + 2.0 * static_cast<double>(i), .end = 2.5 + 2.0 * static_cast<double>(i)};
    const SegmentPath path = integrate_segment(model, truth, inputs, segment);
    last = drive.correlation * last + std::sqrt(1.0 - drive.correlation * drive.correlation) * draw(3);
    pose = compose(pose,
                   drive.correlation > 0.0 ? pushed(path, last) : tests::disturbed_motion(path, kForceNoise, random));
    const Pose2 seen = tests::measured_pose(pose, kForceNoise, random);
    segment.measured = measured_pose(between(observed, seen));
    observed = seen;
    filter.learn(inputs, segment, kForceSpeeds);
  }
  const Estimate reported = filter.reported();
  const Eigen::VectorXd prior_variance = filter.prior_std().cwiseAbs2();
  return {reported.mean - truth, reported.covariance,
          Eigen::VectorXd(reported.covariance.diagonal()(places).cwiseQuotient(prior_variance(places))),
          Eigen::VectorXd(reported.mean(places))};
}

/// Mean over runs of the normalised squared error of some parameters, per parameter.
double nees(const ForceDrive& like, bool of_force, int runs) {
  const BodyForce process(with_force(named_basis("drive-5"), ForceFrame::Body), kLaw);
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    ForceDrive drive = like;
    drive.seed = 7000 + static_cast<std::uint64_t>(run);
    const Outcome outcome = learned(drive);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < outcome.error.size(); ++i) {
      if ((std::ranges::find(process.places(), i) != process.places().end()) == of_force) {
        rows.push_back(i);
      }
    }
    const Eigen::VectorXd error = outcome.error(rows);
    const Eigen::MatrixXd covariance = outcome.covariance(rows, rows);
    sum += error.dot(Cholesky(covariance).solve(error)) / static_cast<double>(rows.size()) / runs;
  }
  return sum;
}

TEST_CASE("force and slip are as uncertain as reported, under white noise and under noise that lasts") {
  for (const double correlation : {0.0, 0.6}) {
    const ForceDrive drive{.correlation = correlation};
    const double force = nees(drive, true, 40);
    const double slip = nees(drive, false, 40);
    CAPTURE(correlation);
    MESSAGE("correlation " << correlation << ": NEES of force " << force << ", of slip " << slip);
    CHECK(force > 0.6);
    CHECK(force < 1.5);
    CHECK(slip > 0.4);
    CHECK(slip < 1.6);
  }
}

TEST_CASE("driving one way only does not tell a force from slip, and the filter knows") {
  const Outcome one_way = learned({.backwards = false, .force = 0.0, .seed = 11, .time_constant = 600.0});
  const Outcome both = learned({.backwards = true, .force = 0.0, .seed = 11, .time_constant = 600.0});
  CHECK(one_way.ratio[0] > 0.5);  // lon.abs(V) against lon.V
  CHECK(both.ratio[0] < 0.3);
}

TEST_CASE("a drive without a force is rarely said to have one") {
  int claims = 0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) {
    const Outcome outcome = learned({.force = 0.0,
                                     .correlation = run % 2 == 0 ? 0.0 : 0.6,
                                     .seed = 9000 + static_cast<std::uint64_t>(run),
                                     .segments = 60});
    const BodyForce process(with_force(named_basis("drive-5"), ForceFrame::Body), kLaw);
    bool claimed = false;
    for (Eigen::Index part = 0; part < 3; ++part) {  // along V and along w of each
      const std::vector<Eigen::Index> rows{process.places()[static_cast<std::size_t>(2 * part)],
                                           process.places()[static_cast<std::size_t>(2 * part + 1)]};
      const Eigen::VectorXd found = outcome.found.segment(2 * part, 2);
      const Eigen::MatrixXd covariance = outcome.covariance(rows, rows);
      claimed = claimed || found.dot(Cholesky(covariance).solve(found)) > 11.83;
    }
    claims += claimed ? 1 : 0;
  }
  MESSAGE(claims << " of " << kRuns);
  CHECK(claims <= 5);
}

}  // namespace
}  // namespace slipwise
