// SPDX-License-Identifier: Apache-2.0
// The layout of a motion model's parameter vector.
#include "slipwise/motion/motion_model.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr std::array<std::string_view, kChannels> kSlipRateUnits{"m/s", "m/s", "rad/s"};
constexpr std::array<std::string_view, kChannels> kSlipRateWords{"forward", "sideways", "angular"};

ParameterInfo slip_info(const Basis& basis, std::size_t i) {
  const auto c = static_cast<std::size_t>(basis.channel(i));
  return {basis.parameter_name(i), std::string(kSlipRateUnits[c]) + " per " + basis.terms()[i].text(),
          "share of " + basis.terms()[i].text() + " in the " + std::string(kSlipRateWords[c]) + " slip rate"};
}

}  // namespace

std::vector<ParameterInfo> MotionModel::parameters() const {
  std::vector<ParameterInfo> infos;
  for (std::size_t i = 0; i < basis_.size(); ++i) {
    infos.push_back(slip_info(basis_, i));
  }
  if (learned_.dynamics) {
    infos.push_back({"log_lag_v", "ln s", "time constant of the speed"});
    infos.push_back({"log_lag_omega", "ln s", "time constant of the yaw rate"});
    infos.push_back({"log_delay_v", "ln s", "transport delay of the speed"});
    infos.push_back({"log_delay_omega", "ln s", "transport delay of the yaw rate"});
  }
  if (learned_.clock_offset) {
    infos.push_back({"clock_offset", "s", "lateness of the pose stamps against the input stamps"});
  }
  return infos;
}

CommandChain MotionModel::chain(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  CommandChain chain;
  Eigen::Index at = slip_size();
  if (learned_.dynamics) {
    chain.lag_v = std::exp(parameters[at++]);
    chain.lag_omega = std::exp(parameters[at++]);
    chain.delay_v = std::exp(parameters[at++]);
    chain.delay_omega = std::exp(parameters[at++]);
  }
  if (learned_.clock_offset) {
    chain.clock_offset = parameters[at];
  }
  return chain;
}

Eigen::MatrixXd MotionModel::chain_jacobian(const CommandChain& chain) const {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(kChainParameters, size() - slip_size());
  Eigen::Index column = 0;
  if (learned_.dynamics) {
    for (const double seconds : {chain.lag_v, chain.lag_omega, chain.delay_v, chain.delay_omega}) {
      jacobian(column, column) = seconds;  // d exp(log s) / d log s = s
      ++column;
    }
  }
  if (learned_.clock_offset) {
    jacobian(kChainParameters - 1, column) = 1.0;
  }
  return jacobian;
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
