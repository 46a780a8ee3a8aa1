// SPDX-License-Identifier: Apache-2.0
// The slip program in lanes: from the drive's mean twist to the tangent of a step.
#pragma once

#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lanes.hpp"
#include "slipwise/rollout/slip_factor.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

template <class L>
struct TangentLanes {
  L::Vector forward;  ///< [m]
  L::Vector left;     ///< [m]
  L::Vector turn;     ///< [rad]
};

/// The factors of one state in every lane.
template <class L>
struct FactorLanes {
  L::Vector value[kSlipFactors];
};

/// The products of a slip program.
template <class L>
struct ProductLanes {
  L::Vector value[kMostProducts];
};

/// How a robot stands on a plane amid a step.
template <class L>
struct GradeLanes {
  L::Vector gx, gy;                               ///< [m/s^2]
  L::Vector cos_pitch, across, cos_roll, upward;  ///< of the rows of A: (cos p, sin p sin r), cos r, cos r / cos p
};

/// The drive's mean over a part.
template <class L>
struct MeanLanes {
  L::Vector v, omega;
  L::Vector vy;  ///< where the robot drives sideways
};

/// What a part slips on.
template <class L>
struct PartSlip {
  const L::Scalar* coefficients;
  const GradeLanes<L>* grade;  ///< null on level ground
  bool sideways;               ///< the robot drives sideways too
};

/// Those of the sideways speed, as Term has them.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void find_sideways_factors(const LaneJob<Scalar>& job, const MeanLanes<L>& mean,
                                          FactorLanes<L>& factors) {
  using Vector = L::Vector;
  const auto at = [&factors](SlipFactor factor) -> Vector& { return factors.value[static_cast<std::size_t>(factor)]; };
  copy(mean.vy, at(SlipFactor::SideV));
  if ((job.factors & bit(SlipFactor::AbsSideV)) != 0) {
    copy(magnitude(mean.vy), at(SlipFactor::AbsSideV));
  }
  if ((job.factors & bit(SlipFactor::ThirdHarmonic)) != 0) {
    const Vector ahead = mean.v * mean.v;
    const Vector aside = mean.vy * mean.vy;
    copy(mean.vy * (ahead * static_cast<Scalar>(3) - aside) / (ahead + aside + job.squared_curvature_speed),
         at(SlipFactor::ThirdHarmonic));
  }
}

/// Without a grade no product has gravity for a factor.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void find_factors(const LaneJob<Scalar>& job, const PartSlip<L>& slip, const MeanLanes<L>& mean,
                                 FactorLanes<L>& factors) {
  using Vector = L::Vector;
  const Vector &v = mean.v, &omega = mean.omega;
  const unsigned used = job.factors;
  Vector one;
  fill(static_cast<Scalar>(1), one);
  const auto at = [&factors](SlipFactor factor) -> Vector& { return factors.value[static_cast<std::size_t>(factor)]; };
  copy(v, at(SlipFactor::V));
  copy(omega, at(SlipFactor::Omega));
  if ((used & bit(SlipFactor::AbsV)) != 0) {
    copy(magnitude(v), at(SlipFactor::AbsV));
  }
  if ((used & bit(SlipFactor::AbsOmega)) != 0) {
    copy(magnitude(omega), at(SlipFactor::AbsOmega));
  }
  if ((used & bit(SlipFactor::SignV)) != 0) {
    copy(sign(v, one), at(SlipFactor::SignV));
  }
  if ((used & bit(SlipFactor::Curvature)) != 0) {
    copy((omega * v) / (v * v + job.squared_curvature_speed), at(SlipFactor::Curvature));
  }
  if ((used & bit(SlipFactor::Moving)) != 0 || slip.grade != nullptr) {
    Vector along = magnitude(v);
    if (slip.sideways) {
      along = along + magnitude(mean.vy);
    }
    const Vector moving = any_nonzero(along, omega, one);
    copy(moving, at(SlipFactor::Moving));
    if (slip.grade != nullptr) {
      copy(moving * slip.grade->gx, at(SlipFactor::GravityX));
      copy(moving * slip.grade->gy, at(SlipFactor::GravityY));
    }
  }
  if (slip.sideways) {
    find_sideways_factors<L>(job, mean, factors);
  }
}

/// Adds a product to the channels that it has a share in: bits 1, 2 and 4.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void add_product(unsigned channels, const typename L::Vector& product, const Scalar* share,
                                TangentLanes<L>& tangent) {
  switch (channels) {  // the same way in every period: one well-predicted jump
    case 1:
      tangent.forward = tangent.forward + product * share[0];
      break;
    case 2:
      tangent.left = tangent.left + product * share[1];
      break;
    case 3:
      tangent.forward = tangent.forward + product * share[0];
      tangent.left = tangent.left + product * share[1];
      break;
    case 4:
      tangent.turn = tangent.turn + product * share[2];
      break;
    case 5:
      tangent.forward = tangent.forward + product * share[0];
      tangent.turn = tangent.turn + product * share[2];
      break;
    case 6:
      tangent.left = tangent.left + product * share[1];
      tangent.turn = tangent.turn + product * share[2];
      break;
    case 7:
      tangent.forward = tangent.forward + product * share[0];
      tangent.left = tangent.left + product * share[1];
      tangent.turn = tangent.turn + product * share[2];
      break;
    default:
      break;
  }
}

/// A program of second degree in speed and curvature (thesis 5.1), nested so that no product is needed by itself:
/// kappa (kappa a + (V b + c)) + V (V d + e), with the yaw rate in the turn.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void quadratic_tangent(const LaneJob<Scalar>& job, const Scalar* coefficients,
                                      const typename L::Vector& v, const typename L::Vector& omega,
                                      TangentLanes<L>& tangent) {
  using Vector = L::Vector;
  const Vector kappa = (omega * v) / (v * v + job.squared_curvature_speed);
  const Scalar* a = coefficients + 3 * job.quadratic.curvature_squared;
  const Scalar* b = coefficients + 3 * job.quadratic.speed_by_curvature;
  const Scalar* c = coefficients + 3 * job.quadratic.curvature;
  const Scalar* d = coefficients + 3 * job.quadratic.speed_squared;
  const Scalar* e = coefficients + 3 * kProductV;
  tangent.forward = kappa * (kappa * a[0] + (v * b[0] + c[0])) + v * (v * d[0] + e[0]);
  tangent.left = kappa * (kappa * a[1] + (v * b[1] + c[1])) + v * (v * d[1] + e[1]);
  tangent.turn = kappa * (kappa * a[2] + (v * b[2] + c[2])) +
                 (v * (v * d[2] + e[2]) + omega * coefficients[3 * kProductOmega + 2]);
}

/// Runs the program: each product is an earlier one times a factor, and has its coefficients in the tangent.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void slip_tangent(const LaneJob<Scalar>& job, const PartSlip<L>& slip, const MeanLanes<L>& mean,
                                 ProductLanes<L>& products, TangentLanes<L>& tangent) {
  FactorLanes<L> factors;
  find_factors<L>(job, slip, mean, factors);
  const typename L::Vector &v = mean.v, &omega = mean.omega;
  const Scalar* coefficients = slip.coefficients;
  copy(v, products.value[kProductV]);
  copy(omega, products.value[kProductOmega]);
  fill(static_cast<Scalar>(1), products.value[kProductOne]);
  tangent.forward = v * coefficients[3 * kProductV] + omega * coefficients[3 * kProductOmega];
  tangent.left = v * coefficients[3 * kProductV + 1] + omega * coefficients[3 * kProductOmega + 1];
  tangent.turn = v * coefficients[3 * kProductV + 2] + omega * coefficients[3 * kProductOmega + 2];
  for (std::size_t i = kFirstProduct; i < job.product_count; ++i) {
    const LaneProduct code = job.products[i];
    const typename L::Vector product = products.value[code.parent] * factors.value[code.factor];
    copy(product, products.value[i]);
    add_product<L>(code.channels, product, coefficients + 3 * i, tangent);
  }
}

/// The tangent of products that were found before, with other coefficients.
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void products_tangent(const LaneJob<Scalar>& job, const Scalar* coefficients,
                                     const ProductLanes<L>& products, TangentLanes<L>& tangent) {
  fill(static_cast<Scalar>(0), tangent.forward);
  copy(tangent.forward, tangent.left);
  copy(tangent.forward, tangent.turn);
  for (std::size_t i = 0; i < job.product_count; ++i) {
    add_product<L>(job.products[i].channels, products.value[i], coefficients + 3 * i, tangent);
  }
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
