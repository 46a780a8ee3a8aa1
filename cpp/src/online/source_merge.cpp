// SPDX-License-Identifier: Apache-2.0
// The earliest segment that no better one overlaps goes first.
#include "slipwise/online/source_merge.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kTouching = 0.03;  // [s] neighbours may overlap by: clocks are not known any better

bool overlap(const Segment& a, const Segment& b) {
  return later(b.end - kTouching, a.start) && later(a.end - kTouching, b.start);
}

}  // namespace

SourceMerge::SourceMerge(std::size_t sources, double longest) : longest_(longest) {
  const double never = -std::numeric_limits<double>::infinity();
  seen_.assign(sources, {.start = never, .noise = 0.0});  // it may be the best
}

void SourceMerge::see(std::size_t source, double start, double noise) {
  seen_[source] = {.start = std::max(seen_[source].start, start), .noise = noise};
}

void SourceMerge::push(MergedSegment segment) {
  const auto start = [](const MergedSegment& each) { return std::tuple(each.driven.segment.start, each.source); };
  const auto place = std::ranges::upper_bound(waiting_, start(segment), {}, start);
  waiting_.insert(place, std::move(segment));
}

/// Whether one that is there is better; of equal sources the first.
bool SourceMerge::beaten(const MergedSegment& segment) const {
  return std::ranges::any_of(waiting_, [&](const MergedSegment& other) {
    const bool better = std::tuple(other.noise, other.source) < std::tuple(segment.noise, segment.source);
    return other.source != segment.source && better && overlap(other.driven.segment, segment.driven.segment);
  });
}

/// Whether no source that was better last can still come with a segment that overlaps.
bool SourceMerge::decided(const MergedSegment& segment, double now) const {
  const double end = segment.driven.segment.end;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const bool passed = !later(end - kTouching, std::max(seen_[i].start, now - longest_));
    const bool better = std::tuple(seen_[i].noise, i) < std::tuple(segment.noise, segment.source);
    if (i != segment.source && better && !passed) {
      return false;
    }
  }
  return true;
}

std::vector<DrivenSegment> SourceMerge::take(double now) {
  std::vector<DrivenSegment> found;
  const auto covered = [&](const MergedSegment& each) { return later(until_ - kTouching, each.driven.segment.start); };
  std::erase_if(waiting_, covered);
  auto next = waiting_.begin();
  while (next != waiting_.end()) {
    if (beaten(*next)) {
      ++next;
    } else if (decided(*next, now)) {
      until_ = next->driven.segment.end;
      found.push_back(std::move(next->driven));
      waiting_.erase(next);
      std::erase_if(waiting_, covered);
      next = waiting_.begin();
    } else {
      break;
    }
  }
  return found;
}

void SourceMerge::restart() { *this = SourceMerge(seen_.size(), longest_); }

}  // namespace slipwise
