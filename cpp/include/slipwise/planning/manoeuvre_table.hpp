// SPDX-License-Identifier: Apache-2.0
// A table of manoeuvres by where they end, to begin the search for one near its result.
#pragma once

#include <cstdint>
#include <vector>

#include "slipwise/planning/reach_goal.hpp"

namespace slipwise {

/// Manoeuvres sampled evenly within bounds, in cells of (x, y, heading), the gentlest of each cell.
class ManoeuvreTable {
 public:
  struct Entry {
    Pose2 end;
    ManoeuvreVector parameters;
    double effort;  ///< turning along the way, then length
  };

  /// `samples` manoeuvres of the problem; the same problem gives the same table.
  ManoeuvreTable(const ReachProblem& problem, int samples);

  /// The entries nearest to a goal, nearest first; `count` at most.
  std::vector<Entry> nearest(const Pose2& goal, int count, double turn_length) const;
  std::size_t size() const { return entries_.size(); }

 private:
  struct Cell {
    int x, y, turn;
  };
  Cell cell_of(const Pose2& pose) const;
  static std::size_t place_of(const Cell& cell);
  std::int32_t& slot(const Cell& cell);
  std::int32_t slot(const Cell& cell) const;
  bool inside(const Cell& cell) const;

  double reach_;  ///< half the width of the table [m]
  std::vector<Entry> entries_;
  std::vector<std::int32_t> slots_;  ///< place of the cell's entry, -1 where there is none
};

}  // namespace slipwise
