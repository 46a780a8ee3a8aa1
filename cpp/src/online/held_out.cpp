// SPDX-License-Identifier: Apache-2.0
// Predicting from what was known, and learning how large errors are.
#include "slipwise/online/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/student_t.hpp"

namespace slipwise {
namespace {

constexpr std::size_t kKept = 16;  // errors after which a fit is kept: those of the last horizons

std::size_t index(Structure structure) { return static_cast<std::size_t>(structure); }

std::vector<const HeldOutPrediction*> pointers(const HeldOutPredictions& predictions) {
  std::vector<const HeldOutPrediction*> found;
  found.reserve(predictions.size());
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    found.push_back(&predictions[i]);
  }
  return found;
}

}  // namespace

HeldOutColumns::HeldOutColumns(const HeldOutPredictions& predictions) : HeldOutColumns(pointers(predictions)) {}

HeldOutColumns::HeldOutColumns(const std::vector<const HeldOutPrediction*>& predictions) {
  if (std::ranges::find(predictions, nullptr) != predictions.end()) {
    throw std::invalid_argument("a prediction is missing");
  }
  const auto count = static_cast<Eigen::Index>(predictions.size());
  for (Numbers* numbers : {&run, &structure}) {
    numbers->resize(count);
  }
  for (Rows<1>* column : {&start, &end, &inflation, &dof, &nominal_nis, &learned_until}) {
    column->resize(count);
  }
  for (Rows<3>* rows : {&pose, &measured, &baseline, &in_sample}) {
    rows->resize(count, 3);
  }
  covariance.resize(count, 9);
  for (Eigen::Index i = 0; i < count; ++i) {
    const HeldOutPrediction& each = *predictions[static_cast<std::size_t>(i)];
    run[i] = static_cast<std::int64_t>(each.run);
    structure[i] = static_cast<std::int64_t>(each.structure);
    start[i] = each.start;
    end[i] = each.end;
    inflation[i] = each.student.inflation;
    dof[i] = each.student.dof;
    nominal_nis[i] = each.nominal_nis;
    learned_until[i] = each.learned_until;
    pose.row(i) = each.pose;
    measured.row(i) = each.measured;
    baseline.row(i) = each.baseline;
    in_sample.row(i) = each.in_sample;
    covariance.row(i) = each.covariance.reshaped<Eigen::RowMajor>();
  }
}

HorizonErrors::HorizonErrors() {
  Known nothing{.until = -std::numeric_limits<double>::infinity(), .students = {}};
  nothing.students.fill(StudentCalibration().fitted());
  known_.push_back(nothing);
}

const HorizonErrors::Known& HorizonErrors::before(double t) const {
  for (std::size_t i = known_.size() - 1; i > 0; --i) {
    if (!later(known_[i].until, t)) {
      return known_[i];
    }
  }
  return known_.front();
}

void HorizonErrors::learn(double end, Structure structure, double squared, double nominal_squared, double age) {
  recent_[index(structure)].learn(squared);
  nominal_[index(structure)].learn(nominal_squared);
  known_.push_back({.until = end, .students = known_.back().students});
  known_.back().students[index(structure)] = recent_[index(structure)].fitted();
  while (known_.size() > kKept && !later(known_[1].until, end - age)) {
    known_.pop_front();
  }
}

StudentT HorizonErrors::nominal(Structure structure) const { return nominal_[index(structure)].fitted(); }

void HorizonErrors::restart_clock() {
  known_.erase(known_.begin(), known_.end() - 1);
  known_.front().until = -std::numeric_limits<double>::infinity();
}

HeldOutErrors::HeldOutErrors(std::vector<double> horizons)
    : horizons_(std::move(horizons)), errors_(horizons_.size()), predictions_(horizons_.size()) {}

StudentT HeldOutErrors::student(double t, double horizon, Structure structure) const {
  if (horizons_.empty()) {
    return {.inflation = 1.0, .dof = kMostDof};
  }
  const auto apart = [&](double each) { return std::abs(std::log(each / horizon)); };
  const auto nearest = std::ranges::min_element(horizons_, {}, apart);
  const auto place = static_cast<std::size_t>(nearest - horizons_.begin());
  return before(place, t - std::max(*nearest, kReady)).students[static_cast<std::size_t>(structure)];
}

std::vector<StudentT> HeldOutErrors::nominal(Structure structure) const {
  std::vector<StudentT> found;
  std::ranges::transform(errors_, std::back_inserter(found),
                         [&](const HorizonErrors& errors) { return errors.nominal(structure); });
  return found;
}

void HeldOutErrors::keep(std::shared_ptr<const HeldOutPrediction> prediction) {
  const std::size_t horizon = prediction->horizon;
  predictions_[horizon].keep(std::move(prediction));
}

void HeldOutErrors::restart_clock() { std::ranges::for_each(errors_, &HorizonErrors::restart_clock); }

void HeldOutErrors::check_loaded(const std::vector<double>& horizons) const {
  archive::require(horizons_ == horizons && errors_.size() == horizons.size() && predictions_.size() == horizons.size(),
                   "errors are of other horizons");
}

}  // namespace slipwise
