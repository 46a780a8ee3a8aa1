// SPDX-License-Identifier: Apache-2.0
// An estimate as it was when less had been measured.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {

/// What a segment is predicted by may not know it, however long it waited to be predicted.
class EstimateHistory {
 public:
  /// `first` is of no time: what was known from the start.
  explicit EstimateHistory(Estimate first = {})
      : known_{{-std::numeric_limits<double>::infinity(), std::move(first)}} {}

  /// Takes an estimate over that was learned from what was measured until then [s].
  void keep(double until, Estimate estimate) {
    if (known_.size() == kMost) {
      known_.erase(known_.begin());
    }
    known_.push_back({until, std::move(estimate)});
  }

  /// The newest one that nothing measured after `t` [s] is part of, or the first. Times that are asked for do not
  /// decrease: what is older is dropped.
  const Estimate& before(double t) {
    auto newest = known_.begin();
    for (auto each = known_.begin(); each != known_.end(); ++each) {
      newest = later(each->until, t) ? newest : each;
    }
    known_.erase(known_.begin(), newest);
    return known_.front().estimate;
  }

  /// Whether nothing is amiss with one that was loaded; estimates are of `size` parameters.
  bool holds(Eigen::Index size) const {
    return !known_.empty() && std::ranges::is_sorted(known_, {}, &Known::until) &&
           std::ranges::all_of(known_, [&](const Known& each) { return each.estimate.mean.size() == size; });
  }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.known_);
  }

 private:
  static constexpr std::size_t kMost = 64;  // no segment waits for a minute

  struct Known {
    double until;  ///< [s]
    Estimate estimate;

    template <class Self, class Archive>
    static void archive(Self& self, Archive& a) {
      a(self.until, self.estimate);
    }
  };

  std::vector<Known> known_;  ///< the oldest first; never empty
};

}  // namespace slipwise
