// SPDX-License-Identifier: Apache-2.0
// What a block of lanes writes: poses after each period, last poses, and a costmap's values along the way.
#pragma once

#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lane_path.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

template <class L, typename Scalar>
SLIPWISE_LANES void store_row(const typename L::Row& row, Scalar* to) {
#pragma GCC unroll 8
  for (std::size_t u = 0; u < L::kVectors; ++u) {
    store(row.part[u], to + u * L::kWidth);
  }
}

template <class L, typename Scalar>
class OutputLanes {
 public:
  SLIPWISE_LANES OutputLanes(const LaneJob<Scalar>& job, const LaneBlock<Scalar>& block) : job_(job), block_(block) {
    for (std::size_t i = 0; i < L::kLanes; ++i) {
      sum_[i] = 0;
      highest_[i] = -__builtin_huge_valf();
      lowest_[i] = __builtin_huge_valf();
    }
  }

  SLIPWISE_LANES void write_period(const PathLanes<L, Scalar>& path, std::size_t period) {
    const std::size_t at = period * job_.rollouts + block_.first;
    write(path.x, block_.x, job_.path[0], at);
    write(path.y, block_.y, job_.path[1], at);
    write(path.turned, block_.theta, job_.path[2], at);
    if (job_.map.cells != nullptr) {
      sample(path);
    }
  }

  SLIPWISE_LANES void write_end(const PathLanes<L, Scalar>& path) const {
    write(path.x, block_.x, job_.end[0], block_.first);
    write(path.y, block_.y, job_.end[1], block_.first);
    write(path.turned, block_.theta, job_.end[2], block_.first);
    write_costs(sum_, job_.cost_sum);
    write_costs(highest_, job_.cost_highest);
    write_costs(lowest_, job_.cost_lowest);
  }

  /// A command that is not finite makes the last pose so too.
  SLIPWISE_LANES bool all_finite(const PathLanes<L, Scalar>& path) const {
    alignas(64) Scalar difference[L::kLanes];
    typename L::Row zero;
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      zero.part[u] = (path.x.part[u] - path.x.part[u]) + (path.y.part[u] - path.y.part[u]);
    }
    store_row<L>(zero, difference);
    bool finite = true;
    for (std::size_t i = 0; i < block_.count; ++i) {
      finite &= difference[i] == 0;
    }
    return finite;
  }

 private:
  /// Writes a row that is counted from the start.
  SLIPWISE_LANES void write(const typename L::Row& row, const Scalar* start, Scalar* to, std::size_t at) const {
    if (to == nullptr) {
      return;
    }
    typename L::Row whole;
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      load(start + u * L::kWidth, whole.part[u]);
      whole.part[u] = whole.part[u] + row.part[u];
    }
    if (block_.count == L::kLanes) {
      store_row<L>(whole, to + at);
      return;
    }
    alignas(64) Scalar values[L::kLanes];
    store_row<L>(whole, values);
    for (std::size_t i = 0; i < block_.count; ++i) {
      to[at + i] = values[i];
    }
  }

  SLIPWISE_LANES void write_costs(const Scalar* costs, Scalar* to) const {
    if (to != nullptr) {
      for (std::size_t i = 0; i < block_.count; ++i) {
        to[block_.first + i] = costs[i];
      }
    }
  }

  /// Looks up the cell of every lane; a pose that is not finite lies outside.
  SLIPWISE_LANES void sample(const PathLanes<L, Scalar>& path) {
    alignas(64) Scalar column[L::kLanes];
    alignas(64) Scalar row[L::kLanes];
    store_row<L>(path.x, column);
    store_row<L>(path.y, row);
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

  const LaneJob<Scalar>& job_;
  const LaneBlock<Scalar>& block_;
  alignas(64) Scalar sum_[L::kLanes];
  alignas(64) Scalar highest_[L::kLanes];
  alignas(64) Scalar lowest_[L::kLanes];
};

}  // namespace slipwise
