// SPDX-License-Identifier: Apache-2.0
// Predicting from what was known, and learning how large errors are.
#include "slipwise/online/held_out.hpp"

#include <limits>

namespace slipwise {
namespace {

constexpr double kRounding = 1e-9;  // [s] of stamps
constexpr std::size_t kKept = 16;   // errors after which a fit is kept: those of the last horizons

std::size_t index(Structure structure) { return static_cast<std::size_t>(structure); }

}  // namespace

HorizonErrors::HorizonErrors() {
  Known nothing{.until = -std::numeric_limits<double>::infinity(), .students = {}};
  nothing.students.fill(StudentCalibration().fitted());
  known_.push_back(nothing);
}

const HorizonErrors::Known& HorizonErrors::before(double t) const {
  for (std::size_t i = known_.size() - 1; i > 0; --i) {
    if (known_[i].until <= t + kRounding) {
      return known_[i];
    }
  }
  return known_.front();
}

void HorizonErrors::learn(double end, Structure structure, double squared, double nominal_squared) {
  recent_[index(structure)].learn(squared);
  nominal_[index(structure)].learn(nominal_squared);
  known_.push_back({.until = end, .students = known_.back().students});
  known_.back().students[index(structure)] = recent_[index(structure)].fitted();
  if (known_.size() > kKept) {
    known_.pop_front();
  }
}

StudentT HorizonErrors::nominal(Structure structure) const { return nominal_[index(structure)].fitted(); }

void HorizonErrors::restart_clock() {
  known_.erase(known_.begin(), known_.end() - 1);
  known_.front().until = -std::numeric_limits<double>::infinity();
}

}  // namespace slipwise
