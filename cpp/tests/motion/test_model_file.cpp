// SPDX-License-Identifier: Apache-2.0
// The model of a file or message: its rows in their places, limits by their names, and what rollouts do not know.
#include "slipwise/motion/model_file.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

namespace slipwise {
namespace {

ModelFile sample() {
  ModelFile file;
  file.basis = "test";
  file.lon = {"V"};
  file.ang = {"w"};
  file.learned = {.dynamics = true, .clock_offset = true, .sensor_extrinsics = true};
  file.limit_gains = {0.9, 1.1};
  file.rows = {{"lon.V", "slip", -0.1},
               {"ang.w", "slip", -0.3},
               {"log_time_constant_v", "actuator", -1.0},
               {"log_time_constant_omega", "actuator", -1.5},
               {"log_delay_v", "actuator", -2.0},
               {"log_delay_omega", "actuator", -2.5},
               {"clock_offset", "clock", 0.05},
               {"sensor_x", "sensor", 0.3},
               {"sensor_y", "sensor", 0.0},
               {"sensor_yaw", "sensor", 0.1},
               {"limits.speed.saturation", "limits", 1.2},
               {"limits.side.slew_rate_down", "limits", 2.0},
               {"limits.wheel_separation", "limits", 0.5},
               {"sensor_x(rtk beside lidar)", "mount", 0.4}};
  const std::size_t size = file.rows.size();
  for (std::size_t i = 0; i < size * size; ++i) {
    file.covariance.push_back(static_cast<double>(i));
  }
  return file;
}

TEST_CASE("parameters of the robot are kept in their order, those of its sensors are not") {
  const RolloutModel model = sample().model();
  REQUIRE(model.parameters.size() == model.motion.size());
  CHECK(model.parameters.isApprox((Eigen::VectorXd(6) << -0.1, -0.3, -1.0, -1.5, -2.0, -2.5).finished()));
  CHECK(model.covariance(5, 3) == 5.0 * 14.0 + 3.0);
  CHECK(model.motion.learned().dynamics);
  CHECK_FALSE(model.motion.learned().clock_offset);
}

TEST_CASE("limits stand where their names say, and what is not limited is not") {
  const CommandLimits limits = sample().model().limits;
  CHECK(limits.speed.saturation == 1.2);
  CHECK(limits.side.slew_rate_down == 2.0);
  CHECK(limits.wheel_separation == 0.5);
  CHECK(limits.gain_v == 0.9);
  CHECK(limits.gain_omega == 1.1);
  CHECK(limits.yaw_rate == AxisLimits{});
}

TEST_CASE("what contradicts itself or is not known to rollouts is refused") {
  const auto refused = [](auto change) {
    ModelFile file = sample();
    change(file);
    CHECK_THROWS_AS(file.model(), std::invalid_argument);
  };
  refused([](ModelFile& file) { file.covariance.pop_back(); });
  refused([](ModelFile& file) { file.limit_gains.pop_back(); });
  refused([](ModelFile& file) { file.rows[0].stage = "car"; });
  refused([](ModelFile& file) { file.rows[2].stage = "sensor"; });
  refused([](ModelFile& file) { file.rows[10].name = "limits.speed.top"; });
  refused([](ModelFile& file) { file.rows[10].name = "limits.tail.saturation"; });
  refused([](ModelFile& file) { file.rows[10].name = "saturation"; });
  refused([](ModelFile& file) { file.rows[10].value = -1.0; });
  refused([](ModelFile& file) { file.rows[0].value = std::numeric_limits<double>::quiet_NaN(); });
  refused([](ModelFile& file) { file.lon[0] = "nonsense"; });
}

}  // namespace
}  // namespace slipwise
