// SPDX-License-Identifier: Apache-2.0
// One pass over the drive steps of a segment: poses, and sums that give the derivative of the last pose.
#include "slipwise/segment/integrate_segment.hpp"

#include <array>

#include "slipwise/slip/slip_surface.hpp"

namespace slipwise {
namespace {

DriveWindow window_of(const Segment& segment) {
  return {.start = segment.start, .end = segment.end, .initial = segment.initial};
}

SlipState slip_state(const DriveStep& step, const Segment& segment) {
  const double rate = step.duration > 0.0 ? 1.0 / step.duration : 0.0;
  return {.v = step.forward * rate, .omega = step.turn * rate, .gx = segment.gx, .gy = segment.gy};
}

Eigen::Vector3d tangent_of(const DriveStep& step, const Eigen::Vector3d& slip) {
  return {step.forward + slip.x() * step.duration, step.left + slip.y() * step.duration,
          step.turn + slip.z() * step.duration};
}

/// Runge-Kutta of fourth order on a constant twist: Simpson's rule over the heading (thesis 3.1).
Pose2 rk4_displacement(const Eigen::Vector3d& tangent) {
  const Eigen::Matrix2d mean =
      (rotation(0.0) + 4.0 * rotation(tangent.z() / 2.0) + rotation(tangent.z())) / 6.0;
  const Eigen::Vector2d p = mean * tangent.head<2>();
  return {p.x(), p.y(), tangent.z()};
}

SegmentPath start_path(const Segment& segment, std::size_t steps) {
  SegmentPath path;
  path.times.reserve(steps + 1);
  path.poses.reserve(steps + 1);
  path.tangents.reserve(steps);
  path.times.push_back(segment.start);
  path.poses.emplace_back();
  return path;
}

void append(SegmentPath& path, const DriveStep& step, const Eigen::Vector3d& tangent, const Pose2& displacement) {
  path.times.push_back(path.times.back() + step.duration);
  path.poses.push_back(compose(path.poses.back(), displacement));
  path.tangents.push_back(tangent);
}

/// Sums of method.md, section 3: columns g = blkdiag(R, 1) E d(tangent), gathered so that any later pose can be differentiated.
class JacobianSums {
 public:
  explicit JacobianSums(Eigen::Index size) : sums_(Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, size)) {}

  /// Adds d(tangent) = along * amount of one parameter, where `world` maps tangents to the world chart.
  void add(Eigen::Index parameter, const Eigen::Vector3d& world_column, const Pose2& next) {
    sums_(0, parameter) += world_column.x() + next.y * world_column.z();
    sums_(1, parameter) += world_column.y() - next.x * world_column.z();
    sums_(2, parameter) += world_column.z();
  }

  Eigen::Matrix<double, 3, Eigen::Dynamic> at(const Pose2& end) const {
    Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian = sums_;
    jacobian.row(0) -= end.y * sums_.row(2);
    jacobian.row(1) += end.x * sums_.row(2);
    return jacobian;
  }

 private:
  Eigen::Matrix<double, 3, Eigen::Dynamic> sums_;
};

/// Derivative of a step's tangent by the chain's parameters: through duration and integrals, and through the slip they cause.
Eigen::Matrix<double, 3, kChainParameters> tangent_by_chain(const DriveStep& step, const DriveStepJacobian& jacobian,
                                                            const SlipRateLinearization& slip, const SlipState& state) {
  Eigen::Matrix<double, 3, kChainParameters> result = jacobian.bottomRows<3>();
  result += slip.slip * jacobian.row(0);
  result += slip.by_drive.col(0) * (jacobian.row(1) - state.v * jacobian.row(0));
  result += slip.by_drive.col(1) * (jacobian.row(3) - state.omega * jacobian.row(0));
  return step.duration > 0.0 ? result : Eigen::Matrix<double, 3, kChainParameters>(jacobian.bottomRows<3>());
}

Eigen::Matrix3d world_jacobian(const Pose2& pose, const Eigen::Vector3d& tangent) {
  Eigen::Matrix3d world = chart_jacobian(tangent);
  world.topRows<2>() = rotation(pose.theta) * world.topRows<2>().eval();
  return world;
}

}  // namespace

SegmentPath integrate_segment(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                              const InputTrack& inputs, const Segment& segment, Integrator integrator) {
  model.check(parameters);
  DriveSteps drive = drive_steps(inputs, model.chain(parameters), window_of(segment));
  SegmentPath path = start_path(segment, drive.steps.size());
  for (const DriveStep& step : drive.steps) {
    const Eigen::Vector3d slip = slip_rate(model.basis(), parameters.head(model.slip_size()), slip_state(step, segment));
    const Eigen::Vector3d tangent = tangent_of(step, slip);
    append(path, step, tangent, integrator == Integrator::Exact ? exp(tangent) : rk4_displacement(tangent));
  }
  path.drive = std::move(drive.steps);
  return path;
}

SegmentLinearization linearize_segment(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                       const InputTrack& inputs, const Segment& segment) {
  model.check(parameters);
  const CommandChain chain = model.chain(parameters);
  const bool chain_learned = model.size() > model.slip_size();
  DriveSteps drive = chain_learned ? linearize_drive_steps(inputs, chain, window_of(segment))
                                   : drive_steps(inputs, chain, window_of(segment));
  const Basis& basis = model.basis();
  const auto alpha = parameters.head(model.slip_size());
  SegmentPath path = start_path(segment, drive.steps.size());
  JacobianSums slip_sums(model.slip_size());
  JacobianSums chain_sums(kChainParameters);
  std::vector<double> features(basis.size());
  for (std::size_t k = 0; k < drive.steps.size(); ++k) {
    const DriveStep& step = drive.steps[k];
    const SlipState state = slip_state(step, segment);
    basis.features(state, features);
    Eigen::Vector3d slip = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < features.size(); ++i) {
      slip[static_cast<Eigen::Index>(basis.channel(i))] += features[i] * alpha[static_cast<Eigen::Index>(i)];
    }
    const Eigen::Vector3d tangent = tangent_of(step, slip);
    const Eigen::Matrix3d world = world_jacobian(path.poses.back(), tangent);
    append(path, step, tangent, exp(tangent));
    const Pose2& next = path.poses.back();
    for (std::size_t i = 0; i < features.size(); ++i) {
      const auto channel = static_cast<Eigen::Index>(basis.channel(i));
      slip_sums.add(static_cast<Eigen::Index>(i), world.col(channel) * (features[i] * step.duration), next);
    }
    if (chain_learned && !drive.jacobians[k].isZero(0.0)) {
      const auto by_chain =
          tangent_by_chain(step, drive.jacobians[k], linearize_slip_rate(basis, alpha, state), state);
      for (Eigen::Index j = 0; j < kChainParameters; ++j) {
        chain_sums.add(j, world * by_chain.col(j), next);
      }
    }
  }
  SegmentLinearization result{.path = {}, .predicted = path.poses.back(), .by_parameter = {}};
  result.by_parameter.resize(3, model.size());
  result.by_parameter.leftCols(model.slip_size()) = slip_sums.at(result.predicted);
  if (chain_learned) {
    result.by_parameter.rightCols(model.size() - model.slip_size()) =
        chain_sums.at(result.predicted) * model.chain_jacobian(chain);
  }
  path.drive = std::move(drive.steps);
  result.path = std::move(path);
  return result;
}

}  // namespace slipwise
