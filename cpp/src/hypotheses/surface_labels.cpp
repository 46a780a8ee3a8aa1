// SPDX-License-Identifier: Apache-2.0
// What a label says of each surface, and whether it was right.
#include "slipwise/hypotheses/surface_labels.hpp"

#include <algorithm>

namespace slipwise {

using Kind = SurfaceCandidate::Kind;

void SurfaceLabels::start_drive(const std::string& label, const SurfaceList& surfaces) {
  wanted_.clear();
  change(label, surfaces);
}

void SurfaceLabels::change(const std::string& label, const SurfaceList& surfaces) {
  label_ = label;
  wanted_ = surfaces.size() == 0 ? label_ : wanted_;  // nothing competes
}

std::string SurfaceLabels::name_here(const SurfaceList& surfaces) const {
  return surfaces.present() ? surfaces.present_name() : wanted_;
}

Eigen::ArrayXd SurfaceLabels::factors(const std::vector<SurfaceCandidate>& candidates,
                                      const SurfaceList& surfaces) const {
  const auto count = std::ssize(candidates);
  if (label_.empty() || count < 2) {
    return Eigen::ArrayXd::Ones(count);
  }
  const bool known =
      std::ranges::any_of(candidates, [&](const auto& each) { return surfaces.name_of(each) == label_; });
  Eigen::ArrayXd factors(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SurfaceCandidate& each = candidates[static_cast<std::size_t>(i)];
    const std::string name = surfaces.name_of(each);
    const bool named =
        known ? name == label_ : !each.known() || (each.kind == Kind::Known && SurfaceList::numbered(name));
    factors[i] = named ? counts_.reliability() : (1.0 - counts_.reliability()) / static_cast<double>(count - 1);
  }
  return factors;
}

void SurfaceLabels::weigh(std::vector<SurfaceCandidate>& candidates, const SurfaceList& surfaces) const {
  const Eigen::ArrayXd by_label = factors(candidates, surfaces);
  double total = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i].prior *= by_label[static_cast<Eigen::Index>(i)];
    total += candidates[i].prior;
  }
  std::ranges::for_each(candidates, [&](SurfaceCandidate& each) { each.prior /= total; });
}

std::string SurfaceLabels::judge(const SurfaceCandidate& taken, const std::string& recalled, bool sure,
                                 SurfaceList& surfaces) {
  if (taken.kind != Kind::Present) {
    wanted_.clear();
  }
  if (label_.empty()) {
    return recalled;
  }
  const std::size_t here =
      taken.kind == Kind::Present ? surfaces.present().value_or(surfaces.size()) : surfaces.place_of(recalled);
  const bool entry = here < surfaces.size();
  const bool nameless = entry && SurfaceList::numbered(surfaces[here].name) && !surfaces.taken(label_);
  const bool right = entry ? nameless || surfaces[here].name == label_ : !surfaces.taken(label_);
  if (sure) {  // else nothing but the label may have decided
    counts_.all += 1.0;
    counts_.right += right ? 1.0 : 0.0;
  }
  if (nameless) {
    surfaces[here].name = label_;
  } else if (right && !entry) {
    wanted_ = label_;
  }
  return entry && !recalled.empty() ? surfaces[here].name : recalled;
}

}  // namespace slipwise
