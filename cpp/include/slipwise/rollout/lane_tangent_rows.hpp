// SPDX-License-Identifier: Apache-2.0
// What a block's tangents are kept in: rows of lanes, and a copy of them while the path goes to a period's end alone.
#pragma once

#include "slipwise/rollout/lane_tangent_job.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

/// Derivatives of (x, y, heading) by each column, sums of noise, derivatives of the drive's (input, fast, slow) in each
/// channel by each parameter of the actuator, and of the way by each column.
template <class L>
class TangentRows {
 public:
  using Scalar = L::Scalar;
  using Vector = L::Vector;

  SLIPWISE_LANES TangentRows(const LaneTangents<Scalar>& plan, std::size_t channels, bool has_way)
      : plan_(plan), channels_(channels), has_way_(has_way), state_(plan.state) {}

  SLIPWISE_LANES std::size_t x_row(std::size_t column) const { return column; }
  SLIPWISE_LANES std::size_t y_row(std::size_t column) const { return plan_.columns + column; }
  SLIPWISE_LANES std::size_t turn_row(std::size_t column) const { return 2 * plan_.columns + column; }
  SLIPWISE_LANES std::size_t noise_row() const { return 3 * plan_.columns; }
  SLIPWISE_LANES std::size_t drive_row(std::size_t i, std::size_t channel) const {
    return noise_row() + kNoiseRows + 3 * (channels_ * i + channel);
  }
  SLIPWISE_LANES std::size_t way_row(std::size_t column) const { return drive_row(plan_.actuator, 0) + column; }

  SLIPWISE_LANES Vector get(std::size_t row) const {
    Vector value;
    load(state_ + row * L::kLanes, value);
    return value;
  }
  SLIPWISE_LANES void put(std::size_t row, const Vector& value) { store(value, state_ + row * L::kLanes); }
  SLIPWISE_LANES void add(std::size_t row, const Vector& value) { put(row, get(row) + value); }

  /// All are zero.
  SLIPWISE_LANES void clear() {
    for (std::size_t row = 0; row < size(); ++row) {
      put(row, Vector{});
    }
  }
  /// Goes on in the copy, until it is taken up again from here.
  SLIPWISE_LANES void put_aside() {
    Scalar* copy = plan_.state + tangent_rows(plan_) * L::kLanes;
    for (std::size_t row = 0; row < size(); ++row) {
      store(get(row), copy + row * L::kLanes);
    }
    state_ = copy;
  }
  SLIPWISE_LANES void take_up() { state_ = plan_.state; }

 private:
  SLIPWISE_LANES std::size_t size() const { return way_row(has_way_ ? plan_.columns : 0); }

  const LaneTangents<Scalar>& plan_;
  std::size_t channels_;  ///< of the drive
  bool has_way_;          ///< slip hangs on the way
  Scalar* state_;
};

}  // namespace slipwise
