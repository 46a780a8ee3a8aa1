// SPDX-License-Identifier: Apache-2.0
// Motion models and manoeuvres for the tests of planning, over all bases and with all parts of the actuator.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "sample_bases.hpp"
#include "slipwise/planning/trajectory.hpp"

namespace slipwise::tests {

/// A basis with slip of plausible size, with or without lag and delay that differ between the channels.
struct SampleModel {
  std::string name;
  MotionModel motion;
  Eigen::VectorXd parameters;
};

inline SampleModel sample_model(const Basis& basis, bool dynamics) {
  MotionModel motion(basis, {.dynamics = dynamics});
  Eigen::VectorXd parameters(motion.size());
  parameters.head(motion.slip_size()) = sample_slip(basis, 5);
  if (dynamics) {
    parameters.tail(4) << std::log(0.31), std::log(0.22), std::log(0.0827), std::log(0.1133);
  }
  return {basis.name() + (dynamics ? " with actuator" : ""), std::move(motion), std::move(parameters)};
}

/// Curvatures up to 0.8 1/m, lengths from 0.5 m to `longest`.
inline ManoeuvreBounds sample_bounds(double longest) {
  ManoeuvreBounds bounds;
  bounds.low.setConstant(-0.8);
  bounds.high.setConstant(0.8);
  bounds.low[kLength] = 0.5;
  bounds.high[kLength] = longest;
  return bounds;
}

/// A sample model with gains and a slow mode that differ between the channels.
inline SampleModel responding_model(const Basis& basis) {
  MotionModel motion(basis, {.dynamics = true, .response = true});
  Eigen::VectorXd parameters(motion.size());
  parameters.head(motion.slip_size()) = sample_slip(basis, 5);
  parameters.tail(10) << std::log(0.31), std::log(0.22), std::log(0.0827), std::log(0.1133), 0.9, 1.1, 0.25, 0.15,
      std::log(1.7), std::log(1.3);
  return {basis.name() + " with response", std::move(motion), std::move(parameters)};
}

/// The same model of a robot that steers.
inline SampleModel steering(const SampleModel& model) {
  ActuatorParameters learned = model.motion.learned();
  learned.wheelbase = 0.4;
  return {model.name + ", steering", MotionModel(model.motion.basis(), learned), model.parameters};
}

inline std::vector<SampleModel> sample_models() {
  const Basis bent = named_basis("odd-even-10");
  std::vector<SampleModel> models{steering(sample_model(bent, false)), steering(sample_model(bent, true)),
                                  steering(responding_model(bent))};
  for (const Basis& basis : all_bases()) {
    models.push_back(sample_model(basis, false));
    models.push_back(sample_model(basis, true));
    models.push_back(responding_model(basis));
  }
  return models;
}

/// A manoeuvre anywhere within its bounds.
inline ManoeuvreVector random_manoeuvre(const ManoeuvreBounds& bounds, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  ManoeuvreVector parameters;
  for (int i = 0; i < kManoeuvreParameters; ++i) {
    parameters[i] = bounds.low[i] + (bounds.high[i] - bounds.low[i]) * uniform(random);
  }
  return parameters;
}

}  // namespace slipwise::tests
