// SPDX-License-Identifier: Apache-2.0
// What sensors measured, one after the other.
#include "slipwise/sensor/sensor.hpp"

#include <stdexcept>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

template <class All, class Next>
void add(All& all, const Next& next) {
  if (all.size() + next.size() > kMostRows) {
    throw std::invalid_argument("sensors measured more than seven numbers of one segment");
  }
  all.conservativeResize(all.size() + next.size());
  all.tail(next.size()) = next;
}

}  // namespace

Directions directions(const Sensor& sensor) {
  return std::visit([](const auto& kind) { return kind.directions(); }, sensor.kind);
}

Moments moments(const Sensor& sensor, double start, double end) {
  Moments at = std::visit([&](const auto& kind) { return kind.moments(start, end); }, sensor.kind);
  at.array() -= sensor.clock;
  return at;
}

Seen see(const Sensor& sensor, const View& view) {
  return std::visit([&](const auto& kind) { return kind.see(view); }, sensor.kind);
}

RowsCovariance measurement_noise(const Sensor& sensor, const View& view, const MotionNoise& noise) {
  return std::visit([&](const auto& kind) { return kind.noise(view, noise); }, sensor.kind);
}

void come_earlier(Sensor& sensor, double seconds) {
  std::visit([&](auto& kind) { kind.come_earlier(seconds); }, sensor.kind);
}

std::vector<Measured> measured_pose(const Pose2& motion, const Pose2& place) {
  return {{.sensor = {.place = place}, .z = motion.vector()}};
}

Rows rows_of(const std::vector<Measured>& measured) {
  Rows all;
  for (const Measured& each : measured) {
    add(all, each.z);
  }
  return all;
}

Rows stacked(const std::vector<Seen>& seen) {
  Rows all;
  for (const Seen& each : seen) {
    add(all, each.z);
  }
  return all;
}

Directions directions_of(const std::vector<Measured>& measured) {
  Directions all;
  for (const Measured& each : measured) {
    add(all, directions(each.sensor));
  }
  return all;
}

Rows noise_factors(const std::vector<Measured>& measured, const Eigen::Vector3d& scale) {
  Rows all;
  for (const auto& [sensor, z] : measured) {
    const Eigen::Vector3d size =
        sensor.own_noise ? sensor.noise_factor : Eigen::Vector3d(sensor.noise_factor.cwiseProduct(scale));
    add(all, size(directions(sensor)));
  }
  return all;
}

Pose2 motion_of(const std::vector<Measured>& measured) {
  const Directions directions = directions_of(measured);
  if (directions.size() != 3 || directions != PoseSensor::directions()) {
    throw std::invalid_argument("needs segments between poses or positions; a gyro alone measures none");
  }
  return Pose2::from_vector(rows_of(measured));
}

Eigen::Vector3d chart_of(const Directions& directions, const Rows& rows) {
  Eigen::Vector3d chart = Eigen::Vector3d::Zero();
  for (Eigen::Index i = rows.size() - 1; i >= 0; --i) {  // of several ways the first, of several turns the sum
    chart[directions[i]] = rows[i] + (directions[i] == kTurn ? chart[kTurn] : 0.0);
  }
  return chart;
}

Eigen::Matrix3d chart_covariance(const Directions& directions, const RowsCovariance& covariance) {
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMostRows> taken(3, directions.size());
  taken.setZero();
  Eigen::Vector3d unknown = Eigen::Vector3d::Ones();
  for (Eigen::Index i = 0; i < directions.size(); ++i) {
    taken(directions[i], i) = directions[i] == kTurn ? 1.0 : unknown[directions[i]];
    unknown[directions[i]] = 0.0;
  }
  Eigen::Matrix3d chart = taken * covariance * taken.transpose();
  chart.diagonal() += unknown;
  return chart;
}

Rows shorter_error(const Directions& directions, const Rows& measured, const Rows& predicted) {
  Rows error = measured - predicted;
  for (Eigen::Index i = 0; i < error.size(); ++i) {
    error[i] = directions[i] == kTurn ? wrap_angle(error[i]) : error[i];
  }
  return error;
}

}  // namespace slipwise
