// SPDX-License-Identifier: Apache-2.0
// The derivative of a segment's last pose by every parameter, over all bases, drives and chains.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "finite_difference.hpp"
#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/segment/carried_linearization.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/slip/force_terms.hpp"

namespace slipwise {
namespace {

constexpr double kStep = 1e-3;

struct Case {
  std::string name;
  ActuatorParameters learned;
  Eigen::VectorXd actuator;  ///< the model's actuator parameters
};

std::vector<Case> sample_chains() {
  const double time_constant_v = std::log(0.31), time_constant_omega = std::log(0.22), delay_v = std::log(0.0827),
               delay_omega = std::log(0.1133);
  Eigen::VectorXd dynamics(4), both(5), all(11), observed(14);
  const Eigen::Vector3d mount(1.5, -0.4, 0.21);
  dynamics << time_constant_v, time_constant_omega, delay_v, delay_omega;
  both << time_constant_v, time_constant_omega, delay_v, delay_omega, 0.0231;
  all << time_constant_v, time_constant_omega, delay_v, delay_omega, 0.93, 1.12, 0.21, 0.34, std::log(1.31),
      std::log(0.82), 0.0231;
  observed << all, mount;
  return {
      {"no actuator", {}, Eigen::VectorXd(0)},
      {"clock offset", {.clock_offset = true}, Eigen::VectorXd::Constant(1, 0.0231)},
      {"dynamics", {.dynamics = true}, dynamics},
      {"dynamics and clock offset", {.dynamics = true, .clock_offset = true}, both},
      {"dynamics, response and clock offset", {.dynamics = true, .clock_offset = true, .response = true}, all},
      {"sensor_extrinsics", {.sensor_extrinsics = true}, mount},
      {"everything", {.dynamics = true, .clock_offset = true, .response = true, .sensor_extrinsics = true}, observed},
      {"delays", {.delays = true}, Eigen::Vector2d(0.0827, -0.0133)},
      {"steering", {.dynamics = true, .wheelbase = 0.4}, dynamics},
      {"steering, response and clock offset",
       {.dynamics = true, .clock_offset = true, .response = true, .wheelbase = 0.4},
       all},
      {"steering, delays", {.delays = true, .wheelbase = 0.4}, Eigen::Vector2d(0.0827, -0.0133)}};
}

Eigen::VectorXd joined(const Eigen::VectorXd& slip, const Eigen::VectorXd& actuator) {
  Eigen::VectorXd all(slip.size() + actuator.size());
  all << slip, actuator;
  return all;
}

double linearization_error(const MotionModel& model, const Eigen::VectorXd& parameters, const InputHistory& inputs,
                           const Segment& segment) {
  const auto value = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return integrate_segment(model, p, inputs, segment).rows();
  };
  const auto numeric = tests::finite_difference(value, parameters, kStep);
  return tests::jacobian_error(linearize_segment(model, parameters, inputs, segment).by_parameter, numeric, 0.1);
}

void check_all_drives(const Basis& basis, const Case& actuator, double period, const Segment& segment) {
  const MotionModel model(basis, actuator.learned);
  const Eigen::VectorXd parameters = joined(tests::sample_slip(basis, 21), actuator.actuator);
  for (const tests::SampleDrive& drive : tests::sample_drives()) {
    CAPTURE(basis.name());
    CAPTURE(actuator.name);
    CAPTURE(drive.name);
    const InputHistory inputs = tests::sampled(drive.twist, 0.0, period, 200);
    CHECK(linearization_error(model, parameters, inputs, segment) < tests::kDerivativeTolerance);
  }
}

const Segment kSegment{.start = 3.0131, .end = 5.0177, .gx = 0.3, .gy = -0.5};

TEST_CASE("linearised segments have the exact derivative by every parameter for all bases, drives and chains") {
  for (const Basis& basis : tests::all_bases()) {
    for (const Case& actuator : sample_chains()) {
      check_all_drives(basis, actuator, 0.05, kSegment);
    }
  }
}

TEST_CASE("linearised segments are exact from a measured initial twist and under commands held for a second") {
  const Basis basis = named_basis("odd-even-10");
  Segment measured = kSegment;
  measured.initial = BodyTwist{0.5, 0.1, 0.4};
  Segment longer = measured;
  longer.start = 3.3131;
  longer.end = 8.2177;
  for (const Case& actuator : sample_chains()) {
    check_all_drives(basis, actuator, 0.05, measured);
    check_all_drives(basis, actuator, 1.0137, longer);
  }
}

// A step slips as its mean twist does, so the path has a faint kink where the two channels' changes swap their order.
TEST_CASE("the derivative where both channels have the same delay is the limit of a yaw rate slightly later") {
  const Basis basis = named_basis("odd-even-10");
  const MotionModel model(basis, {.dynamics = true, .clock_offset = true});
  Eigen::VectorXd equal = joined(tests::sample_slip(basis, 21), sample_chains()[3].actuator);
  equal[model.slip_size() + 3] = equal[model.slip_size() + 2];
  Eigen::VectorXd later = equal;
  later[model.slip_size() + 3] += 1e-7;
  for (const tests::SampleDrive& drive : tests::sample_drives()) {
    CAPTURE(drive.name);
    const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
    const auto at = [&](const Eigen::VectorXd& p) {
      return linearize_segment(model, p, inputs, kSegment).by_parameter;
    };
    CHECK(tests::jacobian_error(at(equal), at(later), 0.1) < 1e-6);
  }
}

TEST_CASE("a segment's beginnings are linearised as segments that end there, and the last is all of it") {
  const Basis basis = named_basis("odd-even-10");
  for (const Case& actuator : sample_chains()) {
    const MotionModel model(basis, actuator.learned);
    const Eigen::VectorXd parameters = joined(tests::sample_slip(basis, 21), actuator.actuator);
    for (const tests::SampleDrive& drive : tests::sample_drives()) {
      CAPTURE(actuator.name);
      CAPTURE(drive.name);
      const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
      const auto beginnings = linearize_beginnings(model, parameters, inputs, kSegment, 5);
      REQUIRE(beginnings.size() == 5);
      for (std::size_t i = 0; i < 5; ++i) {
        Segment part = kSegment;
        part.end = i < 4 ? beginnings[i].path.times.back() : kSegment.end;
        const double wanted = kSegment.start + 0.2 * (kSegment.end - kSegment.start) * static_cast<double>(i + 1);
        CHECK(part.end > wanted - 1e-9);
        CHECK(part.end < wanted + 0.1);
        const auto alone = linearize_segment(model, parameters, inputs, part);
        CHECK((beginnings[i].predicted - alone.predicted).norm() < 1e-9);
        CHECK(beginnings[i].path.poses.size() == beginnings[i].path.drive.size() + 1);
        // The end of a step lies where a delayed input changes: there the derivative by delays has a kink.
        CHECK((beginnings[i].by_parameter - alone.by_parameter).leftCols(model.slip_size()).norm() < 1e-9);
      }
      CHECK(beginnings.back().by_parameter == linearize_segment(model, parameters, inputs, kSegment).by_parameter);
    }
  }
}

TEST_CASE("linearised segments predict what integration predicts") {
  for (const Basis& basis : tests::all_bases()) {
    for (const Case& actuator : sample_chains()) {
      const MotionModel model(basis, actuator.learned);
      const Eigen::VectorXd parameters = joined(tests::sample_slip(basis, 22), actuator.actuator);
      for (const tests::SampleDrive& drive : tests::sample_drives()) {
        const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
        const auto linearized = linearize_segment(model, parameters, inputs, kSegment);
        const SegmentPath path = integrate_segment(model, parameters, inputs, kSegment);
        CHECK((linearized.predicted - path.rows()).norm() < 1e-12);
        REQUIRE(linearized.path.poses.size() == path.poses.size());
        CHECK(linearized.path.times == path.times);
        CHECK(linearized.path.tangents.size() == path.tangents.size());
        CHECK(linearized.path.drive.size() == path.drive.size());
      }
    }
  }
}

TEST_CASE("a linearisation is carried over small steps to a quarter of the noise, and not over large ones") {
  const Basis basis = named_basis("drive-9");
  const double std = 0.01;
  const Eigen::Matrix3d noise = std * std * Eigen::Matrix3d::Identity();
  for (const Case& actuator : sample_chains()) {
    CAPTURE(actuator.name);
    const MotionModel model(basis, actuator.learned);
    const Eigen::VectorXd parameters = joined(tests::sample_slip(basis, 23), actuator.actuator);
    const Eigen::VectorXd pattern = Eigen::VectorXd::LinSpaced(model.size(), -1.0, 1.0);
    for (const tests::SampleDrive& drive : tests::sample_drives()) {
      CAPTURE(drive.name);
      const InputHistory inputs = tests::sampled(drive.twist, 0.0, 0.05, 200);
      const auto at = linearize_segment(model, parameters, inputs, kSegment);
      for (const double size : {0.001, 0.01, 0.03, 0.1}) {
        if (const auto near = carried(at, model, size * pattern, noise)) {
          const auto there = integrate_segment(model, parameters + size * pattern, inputs, kSegment).rows();
          CHECK((near->predicted - there).norm() < 0.25 * std);
        }
      }
      CHECK(carried(at, model, 0.001 * pattern, noise));
      CHECK(!carried(at, model, 10.0 * pattern, noise));
    }
  }
}

TEST_CASE("the derivative is exact for a sensor whose place is known") {
  const Basis basis = named_basis("odd-even-10");
  Segment observed = kSegment;
  observed.measured.front().sensor.place = {-0.7, 0.3, -1.2};
  for (const Case& actuator : sample_chains()) {
    check_all_drives(basis, actuator, 0.05, observed);
  }
}

TEST_CASE("a spin of more than one turn keeps its turns in the prediction") {
  const MotionModel model(named_basis("edd-2"), {});
  const InputHistory inputs = tests::sampled([](double) { return BodyTwist{0.1, 0.0, 5.0}; }, 0.0, 0.05, 100);
  const auto at = linearize_segment(model, Eigen::Vector2d::Zero(), inputs, {.start = 1.0, .end = 3.0});
  CHECK(at.predicted[2] == doctest::Approx(10.0).epsilon(1e-12));
}

TEST_CASE("the derivative is exact where a force turns with the map, on level ground and on a hillside") {
  Segment segment = kSegment;
  segment.heading = 0.8;
  for (const auto& ground : {std::shared_ptr<const Ground>{}, std::make_shared<const Ground>(Grade{0.1, -0.05})}) {
    segment.ground = ground;
    for (const Case& actuator : sample_chains()) {
      check_all_drives(with_force(named_basis("drive-9"), ForceFrame::World), actuator, 0.05, segment);
    }
  }
}

TEST_CASE("with wind the path does not depend on the frame that it is seen from, but on where the wind blows") {
  const MotionModel model(with_force({"none", {}, {}, {}}, ForceFrame::World), {});
  Eigen::VectorXd wind = Eigen::VectorXd::Zero(model.size());
  for (const ForceTerm& term : force_terms(model.basis())) {
    wind[term.place] = term.axis == ForceAxis::WorldX && !term.turning ? 0.1 * term.sign : 0.0;
  }
  const InputHistory inputs({0.0}, {BodyTwist{1.0, 0.0, 0.5}});
  for (const double heading : {0.0, 1.3, -2.0}) {
    CAPTURE(heading);
    const Segment segment{.start = 0.0, .end = 4.0, .heading = heading};
    const Pose2 end = integrate_segment(model, wind, inputs, segment).poses.back();
    const Pose2 without = integrate_segment(model, Eigen::VectorXd::Zero(model.size()), inputs, segment).poses.back();
    const Eigen::Vector2d drift = rotation(heading) * Eigen::Vector2d(end.x - without.x, end.y - without.y);
    CHECK(drift.x() == doctest::Approx(0.4).epsilon(1e-3));  // 0.1 m per metre, 4 m
    CHECK(drift.y() == doctest::Approx(0.0).scale(1.0).epsilon(1e-3));
  }
}

}  // namespace
}  // namespace slipwise
