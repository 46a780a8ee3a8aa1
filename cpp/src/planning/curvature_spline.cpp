// SPDX-License-Identifier: Apache-2.0
// The recursion of Cox and de Boor on uniform inner knots.
#include "slipwise/planning/curvature_spline.hpp"

#include <algorithm>
#include <array>

namespace slipwise {
namespace {

constexpr int kDegree = 3;
constexpr int kSpans = kCurvaturePoints - kDegree;

/// Knot i of the clamped spline: 0 four times, then evenly up to 1, four times.
double knot(int i) { return std::clamp(static_cast<double>(i - kDegree) / kSpans, 0.0, 1.0); }

}  // namespace

CurvatureWeights curvature_weights(double fraction) {
  const double at = std::clamp(fraction, 0.0, 1.0);
  const int span = kDegree + std::min(static_cast<int>(at * kSpans), kSpans - 1);
  std::array<double, kDegree + 1> weight{1.0};
  for (int degree = 1; degree <= kDegree; ++degree) {
    double carried = 0.0;
    for (int j = 0; j < degree; ++j) {
      const double right = knot(span + j + 1);
      const double left = knot(span + 1 - degree + j);
      const double part = weight[static_cast<std::size_t>(j)] / (right - left);
      weight[static_cast<std::size_t>(j)] = carried + (right - at) * part;
      carried = (at - left) * part;
    }
    weight[static_cast<std::size_t>(degree)] = carried;
  }
  CurvatureWeights all = CurvatureWeights::Zero();
  for (int j = 0; j <= kDegree; ++j) {
    all[span - kDegree + j] = weight[static_cast<std::size_t>(j)];
  }
  return all;
}

}  // namespace slipwise
