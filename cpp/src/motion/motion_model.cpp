// SPDX-License-Identifier: Apache-2.0
// The layout of a motion model's parameter vector.
#include "slipwise/motion/motion_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr std::array<std::string_view, kChannels> kSlipRateUnits{"m/s", "m/s", "rad/s"};
constexpr std::array<std::string_view, kChannels> kSlipRateWords{"forward", "sideways", "angular"};

ParameterInfo slip_info(const Basis& basis, std::size_t i) {
  const auto c = static_cast<std::size_t>(basis.channel(i));
  return {basis.parameter_name(i), std::string(kSlipRateUnits[c]) + " per " + basis.terms()[i].text(),
          "fraction of " + basis.terms()[i].text() + " in the " + std::string(kSlipRateWords[c]) + " slip rate"};
}

/// One of the actuator's parameters: where it stands, and whether its logarithm is learned.
struct ActuatorParameter {
  double ActuatorModel::* value;
  bool logarithm;
  const char* name;
  const char* unit;
  const char* description;
};

constexpr Eigen::Index kDelaySeconds = kActuatorParameters;  // row of the first delay in seconds

/// In ActuatorModel's order, then the delays once more: in seconds, not as logarithms.
constexpr std::array<ActuatorParameter, kActuatorParameters + 2> kActuator{{
    {&ActuatorModel::time_constant_v, true, "log_time_constant_v", "ln s", "time constant of the speed"},
    {&ActuatorModel::time_constant_omega, true, "log_time_constant_omega", "ln s", "time constant of the yaw rate"},
    {&ActuatorModel::delay_v, true, "log_delay_v", "ln s", "transport delay of the speed"},
    {&ActuatorModel::delay_omega, true, "log_delay_omega", "ln s", "transport delay of the yaw rate"},
    {&ActuatorModel::clock_offset, false, "clock_offset", "s", "lateness of the pose stamps against the input stamps"},
    {&ActuatorModel::gain_v, false, "gain_v", "-", "drive over input, of the speed"},
    {&ActuatorModel::gain_omega, false, "gain_omega", "-", "drive over input, of the yaw rate"},
    {&ActuatorModel::slow_fraction_v, false, "slow_fraction_v", "-", "fraction of the speed that follows slowly"},
    {&ActuatorModel::slow_fraction_omega, false, "slow_fraction_omega", "-",
     "fraction of the yaw rate that follows slowly"},
    {&ActuatorModel::slow_time_constant_v, true, "log_slow_time_constant_v", "ln s", "slow time constant of the speed"},
    {&ActuatorModel::slow_time_constant_omega, true, "log_slow_time_constant_omega", "ln s",
     "slow time constant of the yaw rate"},
    {&ActuatorModel::delay_v, false, "delay_v", "s", "how much later than its command the speed is there"},
    {&ActuatorModel::delay_omega, false, "delay_omega", "s", "how much later than its command the yaw rate is there"},
}};

SLIPWISE_TUNING(kNominalResponse, 0.3);  // [s]
SLIPWISE_TUNING(kShortResponse, 0.03);   // [s]; that much shorter times can hardly be distinguished

const ActuatorParameter& actuator_parameter(Eigen::Index row) { return kActuator[static_cast<std::size_t>(row)]; }

/// Where the robot steers, the second channel is that of the steering.
std::string described(std::string description, bool steers) {
  constexpr std::string_view kTurn = "yaw rate";
  const std::size_t at = steers ? description.find(kTurn) : std::string::npos;
  return at == std::string::npos ? description : description.replace(at, kTurn.size(), "steering");
}

Eigen::Index place_of(Eigen::Index row) { return row < kDelaySeconds ? row : kDelayV + row - kDelaySeconds; }

}  // namespace

double log_time_derivative(double seconds) { return (seconds + kShortResponse) / (seconds + kNominalResponse); }

MotionModel::MotionModel() : MotionModel({"none", {}, {}, {}}, {}) {}

MotionModel::MotionModel(Basis basis, ActuatorParameters learned) : basis_(std::move(basis)), learned_(learned) {
  const bool both = learned_.dynamics || learned_.response;
  if ((learned_.delays && learned_.lags) || (both && (learned_.delays || learned_.lags))) {
    throw std::invalid_argument("a motion model has lags and delays, or one of them alone, not both");
  }
  if (!(learned_.wheelbase >= 0.0) || !std::isfinite(learned_.wheelbase)) {
    throw std::invalid_argument("the wheelbase of a motion model must be positive [m], or 0 where nothing steers");
  }
  const auto add = [this](bool wanted, std::initializer_list<Eigen::Index> rows) {
    if (wanted) {
      actuator_rows_.insert(actuator_rows_.end(), rows);
    }
  };
  add(learned_.dynamics, {0, 1, 2, 3});
  add(learned_.lags, {0, 1});
  add(learned_.delays, {kDelaySeconds, kDelaySeconds + 1});
  add(learned_.response, {5, 6, 7, 8, 9, 10});
  add(learned_.clock_offset, {kClockOffset});
  std::ranges::transform(actuator_rows_, std::back_inserter(actuator_places_), place_of);
}

std::vector<ParameterInfo> MotionModel::parameters() const {
  std::vector<ParameterInfo> infos;
  for (std::size_t i = 0; i < basis_.size(); ++i) {
    infos.push_back(slip_info(basis_, i));
  }
  for (const Eigen::Index row : actuator_rows_) {
    const ActuatorParameter& parameter = actuator_parameter(row);
    infos.push_back({parameter.name, parameter.unit, described(parameter.description, learned_.wheelbase > 0.0)});
  }
  if (learned_.sensor_extrinsics) {
    infos.insert(infos.end(), {{"sensor_x", "m", "how far the pose sensor sits ahead of base_link"},
                               {"sensor_y", "m", "how far the pose sensor sits to the left of base_link"},
                               {"sensor_yaw", "rad", "how far the pose sensor is turned to the left of base_link"}});
  }
  return infos;
}

ActuatorModel MotionModel::actuator(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  ActuatorModel actuator;
  actuator.wheelbase = learned_.wheelbase;
  actuator.follows_wheels = learned_.lags;
  Eigen::Index at = slip_size();
  for (const Eigen::Index row : actuator_rows_) {
    const ActuatorParameter& parameter = actuator_parameter(row);
    actuator.*parameter.value = parameter.logarithm ? std::exp(parameters[at]) : parameters[at];
    ++at;
  }
  return actuator;
}

Pose2 MotionModel::sensor_extrinsics(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return learned_.sensor_extrinsics ? Pose2::from_vector(parameters.tail<kExtrinsicsParameters>()) : Pose2{};
}

Eigen::VectorXd MotionModel::actuator_scales(const ActuatorModel& actuator) const {
  Eigen::VectorXd scales(actuator_size());
  Eigen::Index at = 0;
  for (const Eigen::Index row : actuator_rows_) {
    const ActuatorParameter& parameter = actuator_parameter(row);
    scales[at++] = parameter.logarithm ? actuator.*parameter.value : 1.0;
  }
  return scales;
}

Eigen::VectorXd MotionModel::log_time_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  Eigen::VectorXd derivatives = Eigen::VectorXd::Ones(size());
  Eigen::Index at = slip_size();
  for (const Eigen::Index row : actuator_rows_) {
    if (actuator_parameter(row).logarithm) {
      derivatives[at] = log_time_derivative(std::exp(parameters[at]));
    }
    ++at;
  }
  return derivatives;
}

void MotionModel::check(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  if (parameters.size() != size()) {
    throw std::invalid_argument("model '" + basis_.name() + "' takes " + std::to_string(size()) + " parameters, got " +
                                std::to_string(parameters.size()));
  }
  if (!parameters.allFinite()) {
    throw std::invalid_argument("a parameter of model '" + basis_.name() + "' is not finite");
  }
}

}  // namespace slipwise
