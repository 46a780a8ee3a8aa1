// SPDX-License-Identifier: Apache-2.0
// A slip basis: the terms of the forward, sideways and angular slip rates (derivations/model.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "slipwise/slip/term.hpp"

namespace slipwise {

enum class Channel : std::uint8_t { Lon, Lat, Ang };
inline constexpr std::size_t kChannels = 3;
inline constexpr std::array<std::string_view, kChannels> kChannelNames{"lon", "lat", "ang"};

/// The features of one state in parameter order (lon terms, lat terms, ang terms), with derivatives when linearised.
struct SlipFeatures {
  Eigen::VectorXd value;     ///< [parameters]
  Eigen::VectorXd by_v;      ///< [parameters]
  Eigen::VectorXd by_omega;  ///< [parameters]
};

/// Terms per channel. Slip is linear in its parameters: slip_c = features_c . alpha_c (thesis 5.1, 6.9).
class Basis {
 public:
  /// \throws std::invalid_argument when a term is wrong or stands twice in a channel.
  Basis(std::string name, std::span<const std::string> lon, std::span<const std::string> lat,
        std::span<const std::string> ang);

  const std::string& name() const { return name_; }
  std::size_t size() const { return terms_.size(); }
  const std::vector<Term>& terms() const { return terms_; }
  Channel channel(std::size_t parameter) const;
  std::size_t begin(Channel channel) const { return begin_[static_cast<std::size_t>(channel)]; }
  std::size_t end(Channel channel) const { return begin_[static_cast<std::size_t>(channel) + 1]; }
  /// Whether a term depends on the sideways speed.
  bool sideways() const { return sideways_; }
  /// Whether a term depends on the gravity that pulls the robot.
  bool by_gravity() const { return by_gravity_; }
  /// Whether a term depends on the heading in the frame of the poses.
  bool by_heading() const { return by_heading_; }
  /// `lon.V`, `ang.V*w`, ...: the parameter's name in files and tables.
  std::string parameter_name(std::size_t parameter) const;

  /// What the constructor takes.
  std::tuple<std::string, std::vector<std::string>, std::vector<std::string>, std::vector<std::string>> definition()
      const;

  /// Writes the features of one state into `value` (length size()).
  void features(const SlipState& state, std::span<double> value) const;
  SlipFeatures linearize_features(const SlipState& state) const;

 private:
  std::string name_;
  std::vector<Term> terms_;
  std::array<std::size_t, kChannels + 1> begin_{};
  // The terms once more in flat arrays, for speed: factors of term i end at factor_end_[i].
  std::vector<double> coefficients_;
  std::vector<std::size_t> factor_end_;
  std::vector<Quantity> factors_;
  bool sideways_ = false;
  bool by_gravity_ = false;
  bool by_heading_ = false;
};

/// A basis by its published name. \throws std::invalid_argument naming the known bases.
Basis named_basis(std::string_view name);
/// Names of all bases that ship, from few parameters to many.
std::vector<std::string> basis_names();
/// The basis that has every term of the given ones, each once.
Basis union_basis(std::string name, std::span<const Basis> bases);
/// For each parameter of `part`, its place in `whole`. \throws std::invalid_argument when a term is missing.
std::vector<std::size_t> parameter_places(const Basis& part, const Basis& whole);

}  // namespace slipwise
