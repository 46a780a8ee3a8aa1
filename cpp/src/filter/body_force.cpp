// SPDX-License-Identifier: Apache-2.0
// The transition of a force between two segments.
#include "slipwise/filter/body_force.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/linear/tuning.hpp"
#include "slipwise/slip/force_terms.hpp"

namespace slipwise {
namespace {

/// Correlation of what one part of a force does while driving and while turning, or along and across: it pushes the
/// same way, and how much more easily the robot gives way in one than in the other is not known.
SLIPWISE_TUNING(kAlike, 0.5);

void check(double number, const char* what) {
  if (!(number >= 0.0) || !std::isfinite(number)) {
    throw std::invalid_argument(std::string(what) + " of a body force must be positive and finite, got " +
                                std::to_string(number));
  }
}

double std_of(const Basis& basis, const ForceTerm& term, const BodyForceSettings& law) {
  const bool turns = basis.channel(static_cast<std::size_t>(term.place)) == Channel::Ang;
  return (turns ? law.turn_std : law.std) * (term.turning ? law.arm : 1.0);
}

}  // namespace

BodyForce::BodyForce(const Basis& basis, const BodyForceSettings& settings) : time_constant_(settings.time_constant) {
  check(settings.time_constant, "the time constant");
  check(settings.std, "the standard deviation");
  check(settings.turn_std, "the standard deviation of the turn");
  check(settings.arm, "the arm");
  if (time_constant_ == 0.0) {
    return;
  }
  const std::vector<ForceTerm> terms = force_terms(basis);
  nominal_.setZero(std::ssize(terms), std::ssize(terms));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    places_.push_back(terms[i].place);
    for (std::size_t j = 0; j < terms.size(); ++j) {
      const ForceTerm& a = terms[i];
      const ForceTerm& b = terms[j];
      if (a.axis == b.axis) {
        const auto channel = [&](const ForceTerm& term) { return basis.channel(static_cast<std::size_t>(term.place)); };
        const double alike = (a.turning == b.turning ? 1.0 : kAlike) * (channel(a) == channel(b) ? 1.0 : kAlike);
        nominal_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            alike * a.sign * b.sign * std_of(basis, a, settings) * std_of(basis, b, settings);
      }
    }
  }
}

Eigen::VectorXd BodyForce::prior_std(Eigen::VectorXd slip_std) const {
  if (learned()) {
    slip_std(places_) = nominal_.diagonal().cwiseSqrt();
  }
  return slip_std;
}

void BodyForce::pass(Estimate& estimate, double seconds) const {
  if (!learned()) {
    return;
  }
  const double keep = seconds >= 0.0 ? std::exp(-seconds / time_constant_) : 0.0;
  for (const Eigen::Index place : places_) {
    estimate.mean[place] *= keep;
    estimate.covariance.row(place) *= keep;
    estimate.covariance.col(place) *= keep;
  }
  estimate.covariance(places_, places_) += (1.0 - keep * keep) * nominal_;
}

}  // namespace slipwise
