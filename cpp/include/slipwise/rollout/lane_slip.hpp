// SPDX-License-Identifier: Apache-2.0
// The slip program in lanes: from the drive's mean twist to the tangent of a step.
#pragma once

#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lanes.hpp"
#include "slipwise/rollout/slip_factor.hpp"

namespace slipwise {

template <class L>
struct TangentLanes {
  typename L::Row forward;  ///< [m]
  typename L::Row left;     ///< [m]
  typename L::Row turn;     ///< [rad]
};

/// The factors of one state in every lane.
template <class L, typename Scalar>
struct FactorLanes {
  typename L::Row value[kSlipFactors];

  SLIPWISE_LANES FactorLanes(const LaneJob<Scalar>& job, const typename L::Row& v, const typename L::Row& omega) {
    const unsigned used = job.factors;
    constexpr auto kOne = static_cast<Scalar>(1);
    const typename L::Vector zero{};
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      const auto& x = v.part[u];
      const auto& w = omega.part[u];
      at(SlipFactor::V, u) = x;
      at(SlipFactor::Omega, u) = w;
      if ((used & bit(SlipFactor::AbsV)) != 0) {
        at(SlipFactor::AbsV, u) = x < zero ? -x : x;
      }
      if ((used & bit(SlipFactor::AbsOmega)) != 0) {
        at(SlipFactor::AbsOmega, u) = w < zero ? -w : w;
      }
      if ((used & bit(SlipFactor::SignV)) != 0) {
        at(SlipFactor::SignV, u) = x < zero ? zero - kOne : (x > zero ? zero + kOne : zero);
      }
      if ((used & bit(SlipFactor::Curvature)) != 0) {
        at(SlipFactor::Curvature, u) = (w * x) / (x * x + job.squared_curvature_speed);
      }
      if ((used & bit(SlipFactor::Moving)) != 0) {
        at(SlipFactor::Moving, u) = x != zero ? zero + kOne : (w != zero ? zero + kOne : zero);
      }
    }
  }

 private:
  SLIPWISE_LANES typename L::Vector& at(SlipFactor factor, std::size_t u) {
    return value[static_cast<std::size_t>(factor)].part[u];
  }
};

template <class L, typename Scalar>
SLIPWISE_LANES void add_product(const typename L::Row& product, const Scalar share, typename L::Row& sum) {
#pragma GCC unroll 8
  for (std::size_t u = 0; u < L::kVectors; ++u) {
    sum.part[u] = sum.part[u] + product.part[u] * share;
  }
}

/// Adds a product to the channels that it has a share in: bits 1, 2 and 4.
template <class L, typename Scalar>
SLIPWISE_LANES void add_shares(unsigned channels, const typename L::Row& product, const Scalar* share,
                               TangentLanes<L>& tangent) {
  switch (channels) {  // the same way in every period: one well-predicted jump
    case 1:
      add_product<L>(product, share[0], tangent.forward);
      break;
    case 2:
      add_product<L>(product, share[1], tangent.left);
      break;
    case 3:
      add_product<L>(product, share[0], tangent.forward);
      add_product<L>(product, share[1], tangent.left);
      break;
    case 4:
      add_product<L>(product, share[2], tangent.turn);
      break;
    case 5:
      add_product<L>(product, share[0], tangent.forward);
      add_product<L>(product, share[2], tangent.turn);
      break;
    case 6:
      add_product<L>(product, share[1], tangent.left);
      add_product<L>(product, share[2], tangent.turn);
      break;
    case 7:
      add_product<L>(product, share[0], tangent.forward);
      add_product<L>(product, share[1], tangent.left);
      add_product<L>(product, share[2], tangent.turn);
      break;
    default:
      break;
  }
}

/// Runs the program: each product is an earlier one times a factor, and has its shares in the tangent.
template <class L, typename Scalar>
SLIPWISE_LANES void slip_tangent(const LaneJob<Scalar>& job, const Scalar* shares, const typename L::Row& v,
                                 const typename L::Row& omega, TangentLanes<L>& tangent) {
  const FactorLanes<L, Scalar> factors(job, v, omega);
  typename L::Row products[kMostProducts];
  products[kProductV] = v;
  products[kProductOmega] = omega;
#pragma GCC unroll 8
  for (std::size_t u = 0; u < L::kVectors; ++u) {
    products[kProductOne].part[u] = typename L::Vector{} + static_cast<Scalar>(1);
    tangent.forward.part[u] = v.part[u] * shares[3 * kProductV];
    tangent.left.part[u] = v.part[u] * shares[3 * kProductV + 1];
    tangent.turn.part[u] = omega.part[u] * shares[3 * kProductOmega + 2];
  }
  add_shares<L>(job.products[kProductV].channels & 4U, v, shares + 3 * kProductV, tangent);
  add_shares<L>(job.products[kProductOmega].channels & 3U, omega, shares + 3 * kProductOmega, tangent);
  for (std::size_t i = kFirstProduct; i < job.product_count; ++i) {
    const LaneProduct code = job.products[i];
    typename L::Row product;
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      product.part[u] = products[code.parent].part[u] * factors.value[code.factor].part[u];
    }
    products[i] = product;
    add_shares<L>(code.channels, product, shares + 3 * i, tangent);
  }
}

}  // namespace slipwise
