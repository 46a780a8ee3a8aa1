// SPDX-License-Identifier: Apache-2.0
// The slip bases that ship, bases written by users, and unions of bases.
#include "slipwise/slip/basis.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

struct NamedTerms {
  std::string_view name;
  std::vector<std::string> lon, lat, ang;
};

/// The table of derivations/model.md, from few parameters to many.
const std::vector<NamedTerms>& shipped() {
  static const std::vector<std::string> thesis{"kappa", "V", "kappa*V", "kappa^2", "V^2"};  // thesis 5.1
  static const std::vector<NamedTerms> bases{
      {"edd-2", {"V"}, {}, {"w"}},
      {"icr-3", {"V"}, {"w"}, {"w"}},  // thesis 2.1 to 2.3
      {"drive-5", {"V"}, {"V*w"}, {"V*w", "V", "w"}},
      {"inertial-5", {"V"}, {"abs(V)*V*w/g"}, {"abs(V)*V*w/g", "V", "w"}},
      {"full-linear-6", {"V", "w"}, {"V", "w"}, {"V", "w"}},
      {"ipem-9", {"V", "abs(w)", "V*abs(w)"}, {"V", "w", "V*w"}, {"V", "w", "V*w"}},
      {"omni-8", {"V", "Vy"}, {"V", "Vy"}, {"V", "Vy", "V3", "w"}},
      {"drive-9", {"V", "gx*abs(V)", "gx*abs(w)"}, {"V*w", "gy*abs(V)", "gy*abs(w)"}, {"V*w", "V", "w"}},
      {"odd-even-10", {"V", "V*abs(w)", "sgn(V)*w^2"}, {"w", "V*w", "w*abs(w)"}, {"w", "V*w", "w*abs(w)", "V"}},
      {"odd-even-13",
       {"V", "V*abs(w)", "sgn(V)*w^2", "gx"},
       {"w", "V*w", "w*abs(w)", "gy"},
       {"w", "V*w", "w*abs(w)", "V", "gy"}},
      {"ipem-13", {"V", "abs(w)", "V*abs(w)", "gx"}, {"V", "w", "V*w", "gy"}, {"V", "w", "V*w", "gx", "gy"}},
      {"thesis-15", thesis, thesis, thesis},
  };
  return bases;
}

std::string joined_names() {
  std::string names;
  for (const auto& basis : shipped()) {
    names += (names.empty() ? "" : ", ") + std::string(basis.name);
  }
  return names;
}

}  // namespace

Basis::Basis(std::string name, std::span<const std::string> lon, std::span<const std::string> lat,
             std::span<const std::string> ang)
    : name_(std::move(name)) {
  const std::array<std::span<const std::string>, kChannels> channels{lon, lat, ang};
  for (std::size_t c = 0; c < kChannels; ++c) {
    begin_[c] = terms_.size();
    for (const std::string& text : channels[c]) {
      Term term = Term::parse(text);
      const auto first = terms_.begin() + static_cast<std::ptrdiff_t>(begin_[c]);
      if (std::ranges::any_of(first, terms_.end(), [&](const Term& t) { return t.text() == term.text(); })) {
        throw std::invalid_argument("basis '" + name_ + "' has the term '" + term.text() + "' twice in channel " +
                                    std::string(kChannelNames[c]) + "; remove one");
      }
      terms_.push_back(std::move(term));
    }
  }
  begin_[kChannels] = terms_.size();
  for (const Term& term : terms_) {
    sideways_ = sideways_ || term.sideways();
    by_gravity_ = by_gravity_ || term.by_gravity();
    by_heading_ = by_heading_ || term.by_heading();
    coefficients_.push_back(term.coefficient());
    factors_.insert(factors_.end(), term.factors().begin(), term.factors().end());
    factor_end_.push_back(factors_.size());
  }
}

std::tuple<std::string, std::vector<std::string>, std::vector<std::string>, std::vector<std::string>>
Basis::definition() const {
  const auto terms = [&](Channel channel) {
    std::vector<std::string> texts;
    for (std::size_t i = begin(channel); i < end(channel); ++i) {
      texts.push_back(terms_[i].text());
    }
    return texts;
  };
  return {name_, terms(Channel::Lon), terms(Channel::Lat), terms(Channel::Ang)};
}

Channel Basis::channel(std::size_t parameter) const {
  return parameter < begin_[1] ? Channel::Lon : (parameter < begin_[2] ? Channel::Lat : Channel::Ang);
}

std::string Basis::parameter_name(std::size_t parameter) const {
  const auto c = static_cast<std::size_t>(channel(parameter));
  return std::string(kChannelNames[c]) + "." + terms_.at(parameter).text();
}

void Basis::features(const SlipState& state, std::span<double> value) const {
  const SlipQuantities quantities(state);
  std::size_t at = 0;
  for (std::size_t i = 0; i < coefficients_.size(); ++i) {
    double product = coefficients_[i];
    for (; at < factor_end_[i]; ++at) {
      product *= quantities.value[static_cast<std::size_t>(factors_[at])];
    }
    value[i] = product;
  }
}

SlipFeatures Basis::linearize_features(const SlipState& state) const {
  const SlipQuantities quantities(state);
  const auto n = static_cast<Eigen::Index>(size());
  SlipFeatures features{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const TermValue term = terms_[static_cast<std::size_t>(i)].linearize(quantities);
    features.value[i] = term.value;
    features.by_v[i] = term.by_v;
    features.by_omega[i] = term.by_omega;
  }
  return features;
}

Basis named_basis(std::string_view name) {
  const auto& bases = shipped();
  const auto found = std::ranges::find(bases, name, &NamedTerms::name);
  if (found == bases.end()) {
    throw std::invalid_argument("unknown slip basis '" + std::string(name) + "'; known are " + joined_names());
  }
  return {std::string(name), found->lon, found->lat, found->ang};
}

std::vector<std::string> basis_names() {
  std::vector<std::string> names;
  std::ranges::transform(shipped(), std::back_inserter(names),
                         [](const auto& basis) { return std::string(basis.name); });
  return names;
}

Basis union_basis(std::string name, std::span<const Basis> bases) {
  std::array<std::vector<std::string>, kChannels> terms;
  for (const Basis& basis : bases) {
    for (std::size_t i = 0; i < basis.size(); ++i) {
      auto& channel = terms[static_cast<std::size_t>(basis.channel(i))];
      const std::string& text = basis.terms()[i].text();
      if (std::ranges::find(channel, text) == channel.end()) {
        channel.push_back(text);
      }
    }
  }
  return {std::move(name), terms[0], terms[1], terms[2]};
}

std::vector<std::size_t> parameter_places(const Basis& part, const Basis& whole) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const std::string name = part.parameter_name(i);
    std::size_t j = 0;
    while (j < whole.size() && whole.parameter_name(j) != name) {
      ++j;
    }
    if (j == whole.size()) {
      throw std::invalid_argument("basis '" + whole.name() + "' lacks the term " + name + " of '" + part.name() + "'");
    }
    places.push_back(j);
  }
  return places;
}

}  // namespace slipwise
