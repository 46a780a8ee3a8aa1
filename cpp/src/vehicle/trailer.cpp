// SPDX-License-Identifier: Apache-2.0
// The law of a trailer, and its derivatives along Runge-Kutta steps.
#include "slipwise/vehicle/trailer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr double kLongest = 0.02;  // [s] of a step

/// The hitch angle with its derivatives by (psi at the start, length, offset), or a rate of these.
using Sensitive = Eigen::RowVector4d;

Sensitive rate_of(const Trailer& trailer, const Sensitive& at, const BodyTwist& twist) {
  const double s = std::sin(at[0]), c = std::cos(at[0]), per_length = 1.0 / trailer.length;
  const double across = twist.v * s - twist.vy * c + trailer.hitch_offset * twist.omega * c;
  const double by_psi = twist.v * c + twist.vy * s - trailer.hitch_offset * twist.omega * s;
  Sensitive rate;
  rate[0] = -twist.omega - across * per_length;
  rate.tail<3>() = -by_psi * per_length * at.tail<3>();
  rate[2] += across * per_length * per_length;
  rate[3] -= twist.omega * c * per_length;
  return rate;
}

}  // namespace

double hitch_rate(const Trailer& trailer, double psi, const BodyTwist& twist) {
  return rate_of(trailer, Sensitive(psi, 1.0, 0.0, 0.0), twist)[0];
}

HitchStep hitch_after(const Trailer& trailer, double psi, const BodyTwist& twist, double duration) {
  if (!(trailer.length > 0.0) || !(duration >= 0.0)) {
    throw std::invalid_argument("a trailer needs a positive length [m], and a step a duration that is not negative");
  }
  const int parts = std::max(1, static_cast<int>(std::ceil(duration / kLongest)));
  const double h = duration / parts;
  Sensitive at(psi, 1.0, 0.0, 0.0);
  for (int k = 0; k < parts; ++k) {
    const Sensitive one = rate_of(trailer, at, twist);
    const Sensitive two = rate_of(trailer, at + 0.5 * h * one, twist);
    const Sensitive three = rate_of(trailer, at + 0.5 * h * two, twist);
    const Sensitive four = rate_of(trailer, at + h * three, twist);
    at += h / 6.0 * (one + 2.0 * two + 2.0 * three + four);
  }
  return {.psi = at[0], .by = at.tail<3>()};
}

Pose2 trailer_pose(const Trailer& trailer, const Pose2& vehicle, double psi) {
  const Pose2 hitch = compose(vehicle, {-trailer.hitch_offset, 0.0, psi});
  return compose(hitch, {-trailer.length, 0.0, 0.0});
}

}  // namespace slipwise
