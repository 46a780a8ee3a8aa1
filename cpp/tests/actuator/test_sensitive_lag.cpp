// SPDX-License-Identifier: Apache-2.0
// The derivatives that a lag carries along equal finite differences over several steps.
#include <doctest/doctest.h>

#include <array>

#include "finite_difference.hpp"
#include "slipwise/actuator/sensitive_lag.hpp"

namespace slipwise {
namespace {

constexpr int kN = 6;
constexpr ChannelPlaces kPlaces{.lag = 0, .delay = 1, .gain = 2, .slow_share = 3, .slow_lag = 4};
constexpr std::array kInputs{1.0, -0.5, 0.8};
constexpr std::array kDurations{0.3, 0.2, 0.4};

/// Integral and output of the slow part and the fast part, where place 1 lengthens the second step.
template <int N>
Eigen::Matrix<double, 4, N + 1> driven(const Eigen::VectorXd& at) {
  const ChannelResponse response{.gain = at[2], .lag = at[0], .slow_share = at[3], .slow_lag = at[4]};
  Eigen::Matrix<double, 4, N + 1> result = Eigen::Matrix<double, 4, N + 1>::Zero();
  for (const bool slow : {false, true}) {
    Sensitive<N> state{.value = 0.3};
    const Eigen::Index row = slow ? 2 : 0;
    for (std::size_t i = 0; i < kInputs.size(); ++i) {
      Eigen::Matrix<double, 1, N> by = Eigen::Matrix<double, 1, N>::Zero();
      if constexpr (N > 0) {
        by[kPlaces.delay] = i == 1 ? 1.0 : 0.0;
      }
      const double duration = kDurations[i] + (i == 1 ? at[1] : 0.0);
      const LagDecay decay(slow ? response.slow_lag : response.lag, duration);
      const auto input = part_of<N>(kInputs[i], response, kPlaces, slow);
      const auto integral = advance<N>(state, input, decay, slow ? kPlaces.slow_lag : kPlaces.lag, by);
      result(row, 0) += integral.value;
      result.row(row).template tail<N>() += integral.slope;
    }
    result(row + 1, 0) = state.value;
    result.row(row + 1).template tail<N>() = state.slope;
  }
  return result;
}

Eigen::VectorXd sample() { return (Eigen::VectorXd(kN) << 0.25, 0.05, 0.9, 0.3, 1.4, 7.0).finished(); }

TEST_CASE("integral and output know their slopes by lag, delay, gain and slow part") {
  const auto value = [](const Eigen::VectorXd& at) -> Eigen::VectorXd { return driven<kN>(at).col(0); };
  const Eigen::MatrixXd numeric = tests::finite_difference(value, sample(), 0.02);
  CHECK(tests::jacobian_error(driven<kN>(sample()).rightCols<kN>(), numeric) < tests::kDerivativeTolerance);
}

TEST_CASE("the values are the same without derivatives") {
  CHECK(driven<0>(sample()).col(0) == driven<kN>(sample()).col(0));
}

TEST_CASE("fast and slow part of an input make up the gain") {
  const ChannelResponse response{.gain = 0.7, .lag = 0.1, .slow_share = 0.4, .slow_lag = 2.0};
  const auto fast = part_of<kN>(2.0, response, kPlaces, false);
  const auto slow = part_of<kN>(2.0, response, kPlaces, true);
  CHECK(fast.value + slow.value == doctest::Approx(1.4));
  CHECK((fast.slope + slow.slope)[kPlaces.slow_share] == doctest::Approx(0.0));
  CHECK((fast.slope + slow.slope)[kPlaces.gain] == doctest::Approx(2.0));
}

}  // namespace
}  // namespace slipwise
