// SPDX-License-Identifier: Apache-2.0
// Sampling manoeuvres by an additive recurrence (Roberts 2018), and finding the nearest ones.
#include "slipwise/planning/manoeuvre_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

constexpr int kAcross = 32;      // cells along x and along y
constexpr int kAround = 24;      // cells of the heading
constexpr int kFarthest = 4;     // cells; beyond that a guess does not help
constexpr double kMargin = 1.1;  // slip may carry a robot further than its commands

/// The root g of g^(d+1) = g + 1, whose powers fill d dimensions evenly.
double even_ratio(int dimensions) {
  double root = 1.5;
  for (int i = 0; i < 60; ++i) {
    root = std::pow(1.0 + root, 1.0 / (dimensions + 1));
  }
  return root;
}

/// Point n of an even sequence within the bounds. Every second one bends less, since gentle manoeuvres are wanted most.
ManoeuvreVector sample(const ManoeuvreBounds& bounds, int n, double ratio) {
  const ManoeuvreVector middle = 0.5 * (bounds.low + bounds.high);
  const ManoeuvreVector half = 0.5 * (bounds.high - bounds.low);
  ManoeuvreVector point;
  double power = 1.0;
  for (int i = 0; i < kManoeuvreParameters; ++i) {
    power /= ratio;
    const double whole = 0.5 + (n + 1) * power;
    const double even = 2.0 * (whole - std::floor(whole)) - 1.0;
    point[i] = middle[i] + half[i] * (n % 2 == 0 || i == kLength ? even : even * std::abs(even));
  }
  return point;
}

double effort_of(const ManoeuvreVector& parameters) {
  return parameters[kLength] * (1.0 + parameters.head<kCurvaturePoints>().squaredNorm());
}

double apart(const Pose2& a, const Pose2& b, double turn_length) {
  const double turn = turn_length * wrap_angle(a.theta - b.theta);
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + turn * turn);
}

}  // namespace

ManoeuvreTable::ManoeuvreTable(const ReachProblem& problem, int samples)
    : reach_(kMargin * problem.bounds.high[kLength]),
      slots_(static_cast<std::size_t>(kAcross) * kAcross * kAround, -1) {
  const double ratio = even_ratio(kManoeuvreParameters);
  for (int n = 0; n < samples; ++n) {
    const ManoeuvreVector parameters = sample(problem.bounds, n, ratio);
    const Pose2 end = manoeuvre_pose(problem.model, problem.frame, parameters, problem.start);
    const Cell cell = cell_of(end);
    if (!inside(cell)) {
      continue;
    }
    const Entry entry{end, parameters, effort_of(parameters)};
    std::int32_t& place = slot(cell);
    if (place < 0) {
      place = static_cast<std::int32_t>(entries_.size());
      entries_.push_back(entry);
    } else if (entry.effort < entries_[static_cast<std::size_t>(place)].effort) {
      entries_[static_cast<std::size_t>(place)] = entry;
    }
  }
}

std::vector<ManoeuvreTable::Entry> ManoeuvreTable::nearest(const Pose2& goal, int count, double turn_length) const {
  const Cell at = cell_of(goal);
  std::vector<std::pair<double, std::int32_t>> found;
  for (int shell = 0; shell <= kFarthest; ++shell) {
    for (int dx = -shell; dx <= shell; ++dx) {
      for (int dy = -shell; dy <= shell; ++dy) {
        const bool edge = std::max(std::abs(dx), std::abs(dy)) == shell;
        for (int turn = -shell; turn <= shell; turn += edge || shell == 0 ? 1 : 2 * shell) {
          const Cell cell{at.x + dx, at.y + dy, (at.turn + turn + kAround) % kAround};
          const std::int32_t place = inside(cell) ? slot(cell) : -1;
          if (place >= 0) {
            found.emplace_back(apart(entries_[static_cast<std::size_t>(place)].end, goal, turn_length), place);
          }
        }
      }
    }
    if (shell > 0 && std::ssize(found) >= count) {
      break;
    }
  }
  const auto kept = static_cast<std::ptrdiff_t>(std::min<std::size_t>(found.size(), static_cast<std::size_t>(count)));
  std::ranges::partial_sort(found, found.begin() + kept);
  std::vector<Entry> result;
  for (auto it = found.begin(); it != found.begin() + kept; ++it) {
    result.push_back(entries_[static_cast<std::size_t>(it->second)]);
  }
  return result;
}

ManoeuvreTable::Cell ManoeuvreTable::cell_of(const Pose2& pose) const {
  const double per_cell = kAcross / (2.0 * reach_);
  const double turn = wrap_angle(pose.theta) / (2.0 * std::numbers::pi) + 0.5;
  return {static_cast<int>(std::floor(std::clamp((pose.x + reach_) * per_cell, -1e6, 1e6))),
          static_cast<int>(std::floor(std::clamp((pose.y + reach_) * per_cell, -1e6, 1e6))),
          static_cast<int>(turn * kAround) % kAround};
}

bool ManoeuvreTable::inside(const Cell& cell) const {
  return cell.x >= 0 && cell.x < kAcross && cell.y >= 0 && cell.y < kAcross;
}

std::size_t ManoeuvreTable::place_of(const Cell& cell) {
  const std::size_t row = static_cast<std::size_t>(cell.x) * kAcross + static_cast<std::size_t>(cell.y);
  return row * kAround + static_cast<std::size_t>(cell.turn);
}

std::int32_t& ManoeuvreTable::slot(const Cell& cell) { return slots_[place_of(cell)]; }

std::int32_t ManoeuvreTable::slot(const Cell& cell) const { return slots_[place_of(cell)]; }

}  // namespace slipwise
