// SPDX-License-Identifier: Apache-2.0
// The model that drives until a valid one is heard: that of `model.h`, where it was exported, else one without slip.
#pragma once

#include <slipwise/motion/model_file.hpp>

#include <string>
#include <vector>

#if __has_include("model.h")
#include "model.h"  // slipwise export model.yaml --to c-header -o model.h
#endif

namespace slipwise_nav2 {

inline slipwise::RolloutModel default_model() {
#ifdef SLIPWISE_PARAMETERS
  const std::vector<std::string> lon{SLIPWISE_TERMS_LON}, lat{SLIPWISE_TERMS_LAT}, ang{SLIPWISE_TERMS_ANG};
  const slipwise::MotionModel model({"learned", lon, lat, ang}, {.dynamics = SLIPWISE_HAS_DYNAMICS,
                                                                 .response = SLIPWISE_HAS_RESPONSE,
                                                                 .delays = SLIPWISE_HAS_DELAYS,
                                                                 .lags = SLIPWISE_HAS_LAGS,
                                                                 .wheelbase = SLIPWISE_WHEELBASE});
  const std::vector<double> values{SLIPWISE_PARAMETERS};
  const slipwise::CommandLimits limits{.speed = {SLIPWISE_LIMITS_SPEED},
                                       .yaw_rate = {SLIPWISE_LIMITS_YAW_RATE},
                                       .side = {SLIPWISE_LIMITS_SIDE},
                                       .wheel_separation = SLIPWISE_LIMITS_WHEEL_SEPARATION,
                                       .gain_v = SLIPWISE_LIMITS_GAIN_V,
                                       .gain_omega = SLIPWISE_LIMITS_GAIN_OMEGA};
  return {model, Eigen::Map<const Eigen::VectorXd>(values.data(), model.size()), {}, limits};
#else
  return {slipwise::MotionModel(), Eigen::VectorXd(), {}, {}};
#endif
}

}  // namespace slipwise_nav2
