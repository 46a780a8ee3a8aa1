// SPDX-License-Identifier: Apache-2.0
// Names of surfaces, and what labels are worth.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slipwise/hypotheses/surface_bank.hpp"

namespace slipwise {
namespace {

using Kind = SurfaceCandidate::Kind;

constexpr std::string_view kNumbered = "surface ";

}  // namespace

bool SurfaceBank::numbered(const std::string& name) {
  return name.starts_with(kNumbered) && name.find_first_not_of("0123456789 ()", kNumbered.size()) == std::string::npos;
}

bool SurfaceBank::taken(const std::string& name) const {
  return std::ranges::find(surfaces_, name, &Surface::name) != surfaces_.end();
}

std::string SurfaceBank::new_name() {
  std::string wanted = std::exchange(wanted_, {});
  if (!wanted.empty() && !taken(wanted)) {
    return wanted;
  }
  std::string name;
  do {
    name = std::string(kNumbered) + std::to_string(++named_);
  } while (taken(name));
  return name;
}

/// How likely the label is on each candidate, by what labels have been worth: it names the surface, or another one. A
/// label that names no surface speaks for a new one.
Eigen::ArrayXd SurfaceBank::label_factors(const std::vector<SurfaceCandidate>& candidates) const {
  const auto count = std::ssize(candidates);
  if (label_.empty() || count < 2) {
    return Eigen::ArrayXd::Ones(count);
  }
  const auto is_named = [&](const SurfaceCandidate& each) {
    return (each.kind == Kind::Known && surfaces_[each.place].name == label_) ||
           (each.kind == Kind::Present && present_ && surfaces_[*present_].name == label_);
  };
  const bool known = std::ranges::any_of(candidates, is_named);
  Eigen::ArrayXd factors(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SurfaceCandidate& each = candidates[static_cast<std::size_t>(i)];
    const bool named = known ? is_named(each) : each.kind == Kind::New;
    factors[i] = named ? label_reliability() : (1.0 - label_reliability()) / static_cast<double>(count - 1);
  }
  return factors;
}

void SurfaceBank::weigh_by_label(std::vector<SurfaceCandidate>& candidates) const {
  const Eigen::ArrayXd factors = label_factors(candidates);
  double total = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i].prior *= factors[static_cast<Eigen::Index>(i)];
    total += candidates[i].prior;
  }
  std::ranges::for_each(candidates, [&](SurfaceCandidate& each) { each.prior /= total; });
}

/// Counts whether the label was right, as far as the surface that was taken tells; returns the name of the one that was
/// recalled. One that had a number for a name gets the label for its name.
std::string SurfaceBank::judge_label(const SurfaceCandidate& candidate, const std::string& recalled, bool sure) {
  if (candidate.kind != Kind::Present) {
    wanted_.clear();
  }
  if (label_.empty()) {
    return recalled;
  }
  const auto here = candidate.kind == Kind::Present && present_
                        ? surfaces_.begin() + static_cast<std::ptrdiff_t>(*present_)
                        : std::ranges::find(surfaces_, recalled, &Surface::name);
  const bool entry = here != surfaces_.end();
  const bool nameless = entry && numbered(here->name) && !taken(label_);
  const bool right = entry ? nameless || here->name == label_ : !taken(label_);
  if (sure) {  // else nothing but the label may have decided
    labels_.all += 1.0;
    labels_.right += right ? 1.0 : 0.0;
  }
  if (nameless) {
    here->name = label_;
  } else if (right && !entry) {
    wanted_ = label_;
  }
  return entry && !recalled.empty() ? here->name : recalled;
}

}  // namespace slipwise
