// SPDX-License-Identifier: Apache-2.0
// One xorshift generator per lane (Marsaglia 2003), so that the loop over lanes has no dependence between them.
#include "slipwise/planning/coloured_noise.hpp"

#include <cmath>
#include <numbers>

namespace slipwise {
namespace {

/// Spreads a seed over the lanes (splitmix64, Steele et al. 2014).
std::uint32_t lane_seed(std::uint64_t seed, std::size_t lane) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (lane + 1);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  const auto low = static_cast<std::uint32_t>(z ^ (z >> 31U));
  return low == 0 ? 1U : low;  // zero is the one state that xorshift never leaves
}

std::uint32_t advanced(std::uint32_t x) {
  x ^= x << 13U;
  x ^= x >> 17U;
  x ^= x << 5U;
  return x;
}

}  // namespace

ColouredNoise::ColouredNoise(std::size_t lanes, float correlation, std::uint64_t seed)
    : keep_(correlation), add_(std::sqrt(1.0F - correlation * correlation)), state_(lanes), value_(lanes) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    state_[lane] = lane_seed(seed, lane);
  }
}

void ColouredNoise::begin() { begun_ = false; }

const std::vector<float>& ColouredNoise::next() {
  const float keep = begun_ ? keep_ : 0.0F;
  // Four numbers of 0 .. 65535: mean 131070, variance (65536^2 - 1) / 3.
  const float add = (begun_ ? add_ : 1.0F) * std::numbers::sqrt3_v<float> / 65536.0F;
  begun_ = true;
  const std::size_t lanes = state_.size();
  std::uint32_t* const state = state_.data();
  float* const value = value_.data();
  for (std::size_t i = 0; i < lanes; ++i) {
    const std::uint32_t first = advanced(state[i]);
    const std::uint32_t second = advanced(first);
    state[i] = second;
    const std::uint32_t sum = (first & 0xffffU) + (first >> 16U) + (second & 0xffffU) + (second >> 16U);
    value[i] = keep * value[i] + add * static_cast<float>(static_cast<std::int32_t>(sum) - 131070);
  }
  return value_;
}

}  // namespace slipwise
