// SPDX-License-Identifier: Apache-2.0
// A leg has the motion and the covariance of a prediction, and says which inputs it hangs on.
#include "slipwise/online/motion_leg.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/filter/causal_filter.hpp"

namespace slipwise {
namespace {

/// A model with lag, delay and clock offset of (0.4, 0.3, 0.2, 0.1, 0.05) s; poses have no noise.
std::shared_ptr<const MotionPosterior> posterior_with(double clock_offset) {
  const MotionModel model(named_basis("full-linear-6"), {.dynamics = true, .clock_offset = true});
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(model.size());
  mean.head(model.slip_size()) = tests::sample_slip(model.basis(), 3);
  const std::vector<ParameterInfo> parameters = model.parameters();
  for (Eigen::Index i = model.slip_size(); i < model.size(); ++i) {
    const std::string& name = parameters[static_cast<std::size_t>(i)].name;
    mean[i] = name == "clock_offset" ? clock_offset : std::log(name.starts_with("log_delay") ? 0.1 : 0.3);
  }
  const Eigen::VectorXd std = Eigen::VectorXd::Constant(model.size(), 0.05);
  const MotionNoise noise{
      .psd_time = {1e-5, 1e-5, 1e-5}, .psd_motion = {1e-3, 1e-3, 1e-3}, .fraction = {0.05, 0.04, 0.03}};
  return std::make_shared<const MotionPosterior>(MotionPosterior{.model = model,
                                                                 .estimate = {mean, std.cwiseAbs2().asDiagonal()},
                                                                 .prior_std = 4.0 * std,
                                                                 .noise = noise,
                                                                 .noise_scale = {1.5, 0.5, 2.0}});
}

LegKnowledge knowledge(double clock_offset, double inflation) {
  return {posterior_with(clock_offset), std::make_shared<const DisturbanceFilter>(), SlipNow{}, inflation};
}

DrivenSegment driven() {
  return {.inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.01, 800),
          .segment = {.start = 6.0, .end = 6.5, .measured = measured_pose({}, {0.3, 0.1, 0.2})}};
}

TEST_CASE("a leg is the prediction of a segment, with its covariance times the inflation") {
  const LegKnowledge known = knowledge(0.05, 1.7);
  const MotionLeg leg = motion_leg(known, driven());
  const auto at =
      linearize_segment(known.posterior->model, known.posterior->estimate.mean, driven().inputs, driven().segment);
  const Eigen::Matrix3d expected = 1.7 * prediction_covariance(at, known.posterior->estimate.covariance,
                                                               known.posterior->noise, known.posterior->noise_scale);
  CHECK(leg.motion.vector() == at.predicted);
  CHECK((leg.covariance() - expected).norm() < 1e-12 * expected.norm());
  CHECK(leg.posterior == known.posterior);
  CHECK(leg.sensor.x == 0.3);
}

TEST_CASE("inputs stamped after a leg's end matter where poses are stamped early, and not otherwise") {
  CHECK(motion_leg(knowledge(0.2, 1.0), driven()).inputs_until == doctest::Approx(6.3));
  CHECK(motion_leg(knowledge(-0.2, 1.0), driven()).inputs_until == doctest::Approx(6.7));
}

TEST_CASE("inputs older than the memory of a leg change nothing of it") {
  const LegKnowledge known = knowledge(0.05, 1.0);
  const double memory = leg_memory(*known.posterior);
  CHECK(memory > 8.0 * 0.3);
  CHECK(memory < 4.0);
  DrivenSegment with_past = driven();
  DrivenSegment without = driven();
  const auto from = static_cast<std::size_t>((6.0 - memory) / 0.01);
  std::vector<double> t;
  std::vector<BodyTwist> twist;
  for (std::size_t i = from; i < with_past.inputs.size(); ++i) {
    t.push_back(i == from ? -1e5 : with_past.inputs.time(i));
    twist.push_back(with_past.inputs.sample(i));
  }
  without.inputs = InputHistory(t, twist);
  const MotionLeg one = motion_leg(known, with_past);
  const MotionLeg other = motion_leg(known, without);
  CHECK((one.motion.vector() - other.motion.vector()).norm() < 1e-4);
}

}  // namespace
}  // namespace slipwise
