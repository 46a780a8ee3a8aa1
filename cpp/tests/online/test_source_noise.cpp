// SPDX-License-Identifier: Apache-2.0
// The size of errors, source by source and fix by fix.
#include "slipwise/online/source_noise.hpp"
#include "slipwise/sensor/pose_sensor.hpp"

#include <doctest/doctest.h>

#include <random>

#include "slipwise/online/pose_fix.hpp"

namespace slipwise {
namespace {

const Eigen::Vector3d kScale(0.01, 0.02, 0.03);
constexpr std::size_t kOther = noise_class(1, PoseFix::Unknown);

/// Shows segments whose errors are `times` as large as the first's.
void show(SourceNoise& noise, std::size_t each, double times, int count) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  noise.meet(each, kScale);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d draw(normal(random), normal(random), normal(random));
    noise.learn(each, PoseSensor::directions(),
                {.squared = times * times * kScale.cwiseProduct(draw.cwiseAbs2()),
                 .open = Eigen::Vector3d::Zero(),
                 .expected = Eigen::Vector3d::Ones()});
  }
}

TEST_CASE("the first source has the noise of the filters; that of another is learned before it teaches") {
  SourceNoise noise;
  show(noise, 0, 1.0, 200);
  CHECK(noise.is_reference({0, 0}));
  CHECK(noise.known({0, 0}));
  CHECK(noise.size({0, 0}, kScale) == kScale);
  CHECK_FALSE(noise.known({0, kOther}));
  show(noise, kOther, 10.0, 2);
  CHECK_FALSE(noise.known({kOther, kOther}));
  show(noise, kOther, 10.0, 200);
  CHECK(noise.known({kOther, kOther}));
  CHECK_FALSE(noise.is_reference({kOther, kOther}));
  const Eigen::Vector3d size = noise.size({kOther, kOther}, kScale);
  const Eigen::Vector3d factor = size.cwiseQuotient(kScale);
  CHECK(factor.minCoeff() > 50.0);
  CHECK(factor.maxCoeff() < 200.0);
  CHECK(noise.beside_best({kOther, kOther}) == doctest::Approx(10.0).epsilon(0.4));
  CHECK(noise.beside_best({0, 0}) == doctest::Approx(1.0));
  CHECK(noise.size({kOther, kOther}, 4.0 * kScale) == size);  // whatever the filters think of the first
  CHECK(noise.size({0, kOther}, kScale).isApprox(0.5 * (size + kScale)));
}

TEST_CASE("the best fix of the first source becomes what others are compared with") {
  SourceNoise noise;
  const std::size_t single = noise_class(0, PoseFix::Single);
  const std::size_t fixed = noise_class(0, PoseFix::RtkFixed);
  noise.meet(single, kScale);
  CHECK(noise.is_reference({single, single}));
  noise.meet(fixed, kScale);
  CHECK(noise.is_reference({fixed, fixed}));
  CHECK(noise.size({single, single}, kScale / 100.0) == kScale);
  noise.meet(noise_class(0, PoseFix::RtkFloat), kScale);
  CHECK(noise.is_reference({fixed, fixed}));
}

TEST_CASE("fixes have names") {
  CHECK(fix_name(PoseFix::RtkFixed) == "rtk_fixed");
  CHECK(fix_name(PoseFix::Unknown).empty());
}

}  // namespace
}  // namespace slipwise
