// SPDX-License-Identifier: Apache-2.0
// From the terms of a basis to products that build on each other.
#include "slipwise/rollout/slip_program.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "slipwise/slip/basis.hpp"

namespace slipwise {
namespace {

class Compiler {
 public:
  explicit Compiler(bool sideways) {
    program_.products = {{kProductOne, SlipFactor::V, {1.0, 0.0, 0.0}},
                         {kProductOne, SlipFactor::Omega, {0.0, 0.0, 1.0}},
                         {kProductOne, SlipFactor::V, {}}};
    if (sideways) {
      program_.products[product(kProductOne, SlipFactor::SideV)].fraction[1] = 1.0;
    }
  }

  void add(const Term& term, std::size_t channel, double alpha, const std::optional<std::array<double, 2>>& gravity) {
    if (term.by_heading()) {
      throw std::invalid_argument("the term '" + term.text() +
                                  "' depends on the heading in the frame of the poses, which rollouts do not know");
    }
    double fraction = alpha * term.coefficient();
    std::vector<SlipFactor> factors;
    for (const Quantity quantity : term.factors()) {
      const bool along_x = quantity == Quantity::GravityX;
      if (is_sideways(quantity)) {
        factors.push_back(sideways_factor(quantity));
      } else if (!is_gravity(quantity)) {
        factors.push_back(static_cast<SlipFactor>(quantity));
      } else if (!gravity) {
        factors.push_back(along_x ? SlipFactor::GravityX : SlipFactor::GravityY);
      } else {
        fraction *= (*gravity)[along_x ? 0 : 1];
        if (std::ranges::find(factors, SlipFactor::Moving) == factors.end()) {
          factors.push_back(SlipFactor::Moving);
        }
      }
    }
    std::ranges::sort(factors);  // terms with the same beginning share it
    std::size_t place = kProductOne;
    for (const SlipFactor factor : factors) {
      place = product(place, factor);
    }
    program_.products[place].fraction[channel] += fraction;
  }

  SlipProgram finish() && {
    if (program_.products.size() > kMostProducts) {
      throw std::invalid_argument("the basis needs " + std::to_string(program_.products.size()) +
                                  " products of speeds, and rollouts have room for " + std::to_string(kMostProducts) +
                                  "; use fewer terms");
    }
    return std::move(program_);
  }

 private:
  static SlipFactor sideways_factor(Quantity quantity) {
    return quantity == Quantity::SideV      ? SlipFactor::SideV
           : quantity == Quantity::AbsSideV ? SlipFactor::AbsSideV
                                            : SlipFactor::ThirdHarmonic;
  }

  /// The place of parent * factor, which is made where it is new.
  std::size_t product(std::size_t parent, SlipFactor factor) {
    if (parent == kProductOne && factor == SlipFactor::V) {
      return kProductV;
    }
    if (parent == kProductOne && factor == SlipFactor::Omega) {
      return kProductOmega;
    }
    auto& products = program_.products;
    for (std::size_t i = kFirstProduct; i < products.size(); ++i) {
      if (products[i].parent == parent && products[i].factor == factor) {
        return i;
      }
    }
    program_.factors |= bit(factor);
    products.push_back({parent, factor, {}});
    return products.size() - 1;
  }

  SlipProgram program_;
};

}  // namespace

std::optional<LaneQuadratic> find_quadratic(const SlipProgram& program) {
  const auto& products = program.products;
  if (products[kProductOmega].fraction[0] != 0.0 || products[kProductOmega].fraction[1] != 0.0) {
    return std::nullopt;
  }
  LaneQuadratic found{kProductOne, kProductOne, kProductOne, kProductOne};
  for (std::size_t i = kFirstProduct; i < products.size(); ++i) {
    const auto& [parent, factor, fraction] = products[i];
    if (factor == SlipFactor::Curvature && parent == kProductOne) {
      found.curvature = i;
    } else if (factor == SlipFactor::Curvature && parent == kProductV) {
      found.speed_by_curvature = i;
    } else if (factor == SlipFactor::Curvature && parent == found.curvature && found.curvature != kProductOne) {
      found.curvature_squared = i;
    } else if (factor == SlipFactor::V && parent == kProductV) {
      found.speed_squared = i;
    } else {
      return std::nullopt;
    }
  }
  return found;
}

SlipProgram compile_slip(const Basis& basis, std::span<const double> alpha,
                         const std::optional<std::array<double, 2>>& gravity, bool sideways) {
  Compiler compiler(sideways);
  for (std::size_t i = 0; i < basis.size(); ++i) {
    compiler.add(basis.terms()[i], static_cast<std::size_t>(basis.channel(i)), alpha[i], gravity);
  }
  return std::move(compiler).finish();
}

}  // namespace slipwise
