// SPDX-License-Identifier: Apache-2.0
// All slip bases that laws and derivatives are checked on: those that ship and one as a user writes it.
#pragma once

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "slipwise/slip/basis.hpp"

namespace slipwise::tests {

/// A toy basis of somebody else, with every kind of factor.
inline Basis user_basis() {
  const std::vector<std::string> lon{"V*abs(w)", "abs(V)*w^2*0.25"};
  const std::vector<std::string> lat{"sgn(V)*w^3", "V^2*w/g", "gy*V"};
  const std::vector<std::string> ang{"kappa*V^2", "gx*w"};
  return {"user", lon, lat, ang};
}

inline std::vector<Basis> all_bases() {
  std::vector<Basis> bases;
  for (const std::string& name : basis_names()) {
    bases.push_back(named_basis(name));
  }
  bases.push_back(user_basis());
  return bases;
}

/// The terms of all of them, but those of sideways speed: nothing that uses it drives sideways.
inline Basis union_of_all() {
  std::vector<Basis> bases = all_bases();
  std::erase_if(bases, [](const Basis& basis) { return basis.name() == "omni-8"; });
  return union_basis("union", bases);
}

/// Slip parameters of a plausible size: every term explains up to `fraction` of a twist near (1 m/s, 1 rad/s).
inline Eigen::VectorXd sample_slip(const Basis& basis, unsigned seed, double fraction = 0.1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-fraction, fraction);
  Eigen::VectorXd alpha(static_cast<Eigen::Index>(basis.size()));
  for (double& value : alpha) {
    value = uniform(random);
  }
  return alpha;
}

}  // namespace slipwise::tests
