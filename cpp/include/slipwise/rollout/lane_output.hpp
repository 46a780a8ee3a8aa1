// SPDX-License-Identifier: Apache-2.0
// What a block of lanes writes: poses after each period, last poses, and a costmap's values along the way.
#pragma once

#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lane_path.hpp"
#include "slipwise/rollout/lanes.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

template <class L>
class OutputLanes {
 public:
  using Scalar = L::Scalar;

  SLIPWISE_LANES OutputLanes(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block)
      : last_piece_(job.pieces - 1), job_(job), block_(block) {
    for (std::size_t i = 0; i < L::kLanes; ++i) {
      sum_[i] = 0;
      highest_[i] = -__builtin_huge_valf();
      lowest_[i] = __builtin_huge_valf();
    }
  }

  /// Whether the poses on the way matter, beside the last ones.
  SLIPWISE_LANES bool wants_periods() const {
    return job_.path[0] != nullptr || job_.path[1] != nullptr || job_.path[2] != nullptr || job_.map.cells != nullptr;
  }

  /// Whether the pose at the end of a piece of a period matters: of the last one.
  SLIPWISE_LANES bool wants_piece(std::size_t piece) const { return piece == last_piece_ && wants_periods(); }

  SLIPWISE_LANES void write_piece(const PathLanes<L>& path, std::size_t piece) {
    if (piece == last_piece_) {
      write_period(path, period_);
      ++period_;
      last_piece_ += job_.pieces;
    }
  }

  SLIPWISE_LANES void write_period(const PathLanes<L>& path, std::size_t period) {
    const std::size_t at = period * job_.rollouts + block_.first;
    write(path.x, block_.x, job_.path[0], at);
    write(path.y, block_.y, job_.path[1], at);
    write(path.turned, block_.theta, job_.path[2], at);
    if (job_.map.cells != nullptr) {
      sample(path);
    }
  }

  SLIPWISE_LANES void write_end(const PathLanes<L>& path) const {
    write(path.x, block_.x, job_.end[0], block_.first);
    write(path.y, block_.y, job_.end[1], block_.first);
    write(path.turned, block_.theta, job_.end[2], block_.first);
    write_costs(sum_, job_.cost_sum);
    write_costs(highest_, job_.cost_highest);
    write_costs(lowest_, job_.cost_lowest);
  }

  /// A command that is not finite makes the last pose so too.
  SLIPWISE_LANES bool all_finite(const PathLanes<L>& path) const {
    alignas(64) Scalar difference[L::kLanes];
    store((path.x - path.x) + (path.y - path.y), difference);
    bool finite = true;
    for (std::size_t i = 0; i < lanes_in<L>(block_); ++i) {
      finite &= difference[i] == 0;
    }
    return finite;
  }

 private:
  /// Writes a row that is counted from the start.
  SLIPWISE_LANES void write(const L::Vector& row, const Scalar* start, Scalar* to, std::size_t at) const {
    if (to == nullptr) {
      return;
    }
    typename L::Vector whole;
    load(start, whole);
    whole = whole + row;
    store_first(whole, lanes_in<L>(block_), to + at);
  }

  SLIPWISE_LANES void write_costs(const Scalar* costs, Scalar* to) const {
    if (to != nullptr) {
      for (std::size_t i = 0; i < lanes_in<L>(block_); ++i) {
        to[block_.first + i] = costs[i];
      }
    }
  }

  /// Looks up the cell of every lane; a pose that is not finite lies outside.
  SLIPWISE_LANES void sample(const PathLanes<L>& path) {
    alignas(64) Scalar column[L::kLanes];
    alignas(64) Scalar row[L::kLanes];
    store(path.x, column);
    store(path.y, row);
    const LaneMap<Scalar>& map = job_.map;
    for (std::size_t i = 0; i < L::kLanes; ++i) {
      const Scalar x = block_.cell_x[i] + column[i] * map.per_metre;
      const Scalar y = block_.cell_y[i] + row[i] * map.per_metre;
      const bool inside = x >= 0 && x < map.width && y >= 0 && y < map.height;
      const std::size_t cell = inside ? static_cast<std::size_t>(y) * map.columns + static_cast<std::size_t>(x) : 0;
      const auto value = static_cast<Scalar>(inside ? map.cells[cell] : map.outside);
      sum_[i] += value;
      highest_[i] = value > highest_[i] ? value : highest_[i];
      lowest_[i] = value < lowest_[i] ? value : lowest_[i];
    }
  }

  alignas(64) Scalar sum_[L::kLanes];
  alignas(64) Scalar highest_[L::kLanes];
  alignas(64) Scalar lowest_[L::kLanes];
  std::size_t period_ = 0;
  std::size_t last_piece_;  ///< of the period
  const LaneJob<Scalar>& job_;
  const LaneBlock<Scalar>& block_;
};

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
