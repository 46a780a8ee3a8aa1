// SPDX-License-Identifier: Apache-2.0
// Slip terms: reading them from text, their value and their derivatives.
#include "slipwise/slip/term.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

struct Spelling {
  std::string_view text;
  Quantity quantity;
};

constexpr std::array<Spelling, kQuantities> kSpellings{{{"V", Quantity::V},
                                                        {"w", Quantity::Omega},
                                                        {"abs(V)", Quantity::AbsV},
                                                        {"abs(w)", Quantity::AbsOmega},
                                                        {"sgn(V)", Quantity::SignV},
                                                        {"kappa", Quantity::Curvature},
                                                        {"gx", Quantity::GravityX},
                                                        {"gy", Quantity::GravityY},
                                                        {"cos(yaw)", Quantity::CosYaw},
                                                        {"sin(yaw)", Quantity::SinYaw},
                                                        {"Vy", Quantity::SideV},
                                                        {"abs(Vy)", Quantity::AbsSideV},
                                                        {"V3", Quantity::ThirdHarmonic}}};
constexpr int kHighestPower = 8;

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw std::invalid_argument("slip term '" + std::string(text) + "' " + why +
                              "; write products such as V*abs(w), sgn(V)*w^2, abs(V)*V*w/g, kappa*V, gx");
}

double number_or_refuse(std::string_view factor, std::string_view text) {
  if (factor == "g") {
    return kStandardGravity;
  }
  double number = 0.0;
  const auto [end, error] = std::from_chars(factor.data(), factor.data() + factor.size(), number);
  if (error != std::errc() || end != factor.data() + factor.size() || !std::isfinite(number) || number == 0.0) {
    refuse(text, "has an unknown factor '" + std::string(factor) + "'");
  }
  return number;
}

int power_of(std::string_view& factor, std::string_view text) {
  const auto caret = factor.find('^');
  if (caret == std::string_view::npos) {
    return 1;
  }
  const std::string_view digits = factor.substr(caret + 1);
  int power = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
  if (error != std::errc() || end != digits.data() + digits.size() || power < 1 || power > kHighestPower) {
    refuse(text, "has a power that is not a whole number from 1 to 8");
  }
  factor = factor.substr(0, caret);
  return power;
}

bool vanishes_when_parked(const std::vector<Quantity>& factors) {
  return std::ranges::any_of(factors, [](Quantity q) { return q != Quantity::SignV && !is_heading(q); });
}

std::string spell(double coefficient, const std::vector<Quantity>& factors) {
  std::ostringstream out;
  out.precision(17);
  for (std::size_t i = 0; i < factors.size();) {
    std::size_t next = i;
    while (next < factors.size() && factors[next] == factors[i]) {
      ++next;
    }
    out << (i > 0 ? "*" : "") << kSpellings[static_cast<std::size_t>(factors[i])].text;
    if (next - i > 1) {
      out << '^' << next - i;
    }
    i = next;
  }
  if (coefficient == 1.0 / kStandardGravity) {
    out << "/g";
  } else if (coefficient != 1.0) {
    out << '*' << coefficient;
  }
  return out.str();
}

}  // namespace

Term::Term(double coefficient, std::vector<Quantity> factors, std::string text)
    : coefficient_(coefficient), factors_(std::move(factors)), text_(std::move(text)) {}

Term Term::parse(std::string_view text) {
  std::string compact;
  std::ranges::copy_if(text, std::back_inserter(compact), [](unsigned char c) { return std::isspace(c) == 0; });
  double coefficient = 1.0;
  std::vector<Quantity> factors;
  bool divide = false;
  for (std::size_t at = 0; at <= compact.size();) {
    const std::size_t stop = std::min(compact.find_first_of("*/", at), compact.size());
    std::string_view factor = std::string_view(compact).substr(at, stop - at);
    const int power = power_of(factor, text);
    const auto* known = std::ranges::find(kSpellings, factor, &Spelling::text);
    if (known == kSpellings.end()) {
      coefficient *= std::pow(number_or_refuse(factor, text), divide ? -power : power);
    } else if (divide) {
      refuse(text, "divides by '" + std::string(factor) + "', which may be zero");
    } else {
      factors.insert(factors.end(), static_cast<std::size_t>(power), known->quantity);
    }
    divide = stop < compact.size() && compact[stop] == '/';
    at = stop + 1;
  }
  if (!std::isnormal(coefficient)) {
    refuse(text, "has numbers whose product is too large or too small");
  }
  if (!vanishes_when_parked(factors)) {
    refuse(text, "does not vanish when the robot is parked");
  }
  std::ranges::sort(factors);
  std::string canonical = spell(coefficient, factors);
  return {coefficient, std::move(factors), std::move(canonical)};
}

bool Term::sideways() const { return std::ranges::any_of(factors_, is_sideways); }
bool Term::by_gravity() const { return std::ranges::any_of(factors_, is_gravity); }
bool Term::by_heading() const { return std::ranges::any_of(factors_, is_heading); }

void SlipQuantities::see_sideways(double v, double vy) {
  const auto side = static_cast<std::size_t>(Quantity::SideV), size = static_cast<std::size_t>(Quantity::AbsSideV),
             third = static_cast<std::size_t>(Quantity::ThirdHarmonic);
  value[side] = vy;
  by_vy[side] = 1.0;
  value[size] = std::abs(vy);
  by_vy[size] = vy > 0.0 ? 1.0 : -1.0;
  // r sin(3 theta) = (3 v^2 vy - vy^3) / r^2, smooth where the robot stands as the curvature is
  const double over = 3.0 * v * v * vy - vy * vy * vy, under = v * v + vy * vy + kCurvatureSpeed * kCurvatureSpeed;
  value[third] = over / under;
  by_v[third] = (6.0 * v * vy - value[third] * 2.0 * v) / under;
  by_vy[third] = (3.0 * v * v - 3.0 * vy * vy - value[third] * 2.0 * vy) / under;
}

double Term::value(const SlipQuantities& q) const {
  double product = coefficient_;
  for (const Quantity factor : factors_) {
    product *= q.value[static_cast<std::size_t>(factor)];
  }
  return product;
}

TermValue Term::linearize(const SlipQuantities& q) const {
  TermValue result{coefficient_, 0.0, 0.0, 0.0};
  for (const Quantity factor : factors_) {
    const auto i = static_cast<std::size_t>(factor);
    result.by_v = result.by_v * q.value[i] + result.value * q.by_v[i];
    result.by_omega = result.by_omega * q.value[i] + result.value * q.by_omega[i];
    result.by_vy = result.by_vy * q.value[i] + result.value * q.by_vy[i];
    result.value *= q.value[i];
  }
  return result;
}

}  // namespace slipwise
