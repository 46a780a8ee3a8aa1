// SPDX-License-Identifier: Apache-2.0
// Segments of several sources of poses become one sequence that is disjoint in time: the better source wins.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// A segment that may be learned.
struct MergedSegment {
  DrivenSegment driven;
  std::size_t source;
  double noise;  ///< how large its errors are: what is smaller wins
};

/// Two segments of the same time see the same slip and the same disturbance: both would count these twice. What is
/// handed out never overlaps and goes forward in time; a segment of a worse source waits until no better one can come.
class SourceMerge {
 public:
  /// `longest` is that of a segment, with all by which a source may be late [s].
  explicit SourceMerge(std::size_t sources = 0, double longest = 0.0);

  /// Takes a segment that teaches.
  void push(MergedSegment segment);
  /// A segment of this source begins here [s], whether it teaches or not: none that starts earlier follows.
  void see(std::size_t source, double start, double noise);
  /// What is decided at `now` [s], in the order of time.
  std::vector<DrivenSegment> take(double now);
  /// All that is left: nothing follows in this run.
  std::vector<DrivenSegment> finish() { return take(std::numeric_limits<double>::infinity()); }
  /// Another run begins.
  void restart();
  const std::vector<MergedSegment>& waiting() const { return waiting_; }

  /// \throws std::invalid_argument where a loaded one is none that `made` could have become.
  void check_loaded(const SourceMerge& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.longest_, self.seen_, self.waiting_, self.until_);
  }

 private:
  struct Seen {
    double start;
    double noise;
  };
  bool beaten(const MergedSegment& segment) const;
  bool decided(const MergedSegment& segment, double now) const;

  double longest_;
  std::vector<Seen> seen_;  ///< the last of each source
  std::vector<MergedSegment> waiting_;
  double until_ = -std::numeric_limits<double>::infinity();  ///< end of the last that was handed out [s]
};

}  // namespace slipwise
