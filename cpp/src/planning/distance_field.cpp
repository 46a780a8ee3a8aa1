// SPDX-License-Identifier: Apache-2.0
// Exact squared distances as lower envelopes of parabolas, column by column and then row by row (Felzenszwalb and
// Huttenlocher 2012).
#include "slipwise/planning/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr double kFar = 1e20;  // squared, in cells: no occupied cell so far

/// The distances along one line: out[q] = min over p of (q - p)^2 + in[p].
class LineTransform {
 public:
  explicit LineTransform(std::size_t longest) : in_(longest), place_(longest), border_(longest + 1) {}

  std::vector<double>& in() { return in_; }

  template <typename Write>
  void run(std::size_t count, const Write& write) {
    std::size_t parabolas = 0;
    for (std::size_t q = 0; q < count; ++q) {
      double from = -std::numeric_limits<double>::infinity();
      while (parabolas > 0) {
        from = crossing(place_[parabolas - 1], q);
        if (from > border_[parabolas - 1]) {
          break;
        }
        --parabolas;
        from = -std::numeric_limits<double>::infinity();
      }
      place_[parabolas] = q;
      border_[parabolas] = from;
      ++parabolas;
    }
    std::size_t k = 0;
    for (std::size_t q = 0; q < count; ++q) {
      while (k + 1 < parabolas && border_[k + 1] < static_cast<double>(q)) {
        ++k;
      }
      const double apart = static_cast<double>(q) - static_cast<double>(place_[k]);
      write(q, apart * apart + in_[place_[k]]);
    }
  }

 private:
  /// Where the parabola at q becomes lower than that at p < q.
  double crossing(std::size_t p, std::size_t q) const {
    const auto a = static_cast<double>(p), b = static_cast<double>(q);
    return ((in_[q] + b * b) - (in_[p] + a * a)) / (2.0 * (b - a));
  }

  std::vector<double> in_;
  std::vector<std::size_t> place_;
  std::vector<double> border_;
};

}  // namespace

std::vector<float> distance_field(std::span<const std::uint8_t> occupied, std::size_t columns, double resolution,
                                  float nothing) {
  if (columns == 0 || occupied.empty() || occupied.size() % columns != 0) {
    throw std::invalid_argument("the map's cells do not fill its columns; give rows of equal length");
  }
  if (!std::isfinite(resolution) || resolution <= 0.0) {
    throw std::invalid_argument("the side of a cell must be positive metres");
  }
  const std::size_t rows = occupied.size() / columns;
  std::vector<double> squared(occupied.size());
  LineTransform line(std::max(rows, columns));
  for (std::size_t x = 0; x < columns; ++x) {
    for (std::size_t y = 0; y < rows; ++y) {
      line.in()[y] = occupied[y * columns + x] != 0 ? 0.0 : kFar;
    }
    line.run(rows, [&](std::size_t y, double value) { squared[y * columns + x] = value; });
  }
  std::vector<float> distance(occupied.size());
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < columns; ++x) {
      line.in()[x] = squared[y * columns + x];
    }
    line.run(columns, [&](std::size_t x, double value) {
      distance[y * columns + x] = value < 0.5 * kFar ? static_cast<float>(resolution * std::sqrt(value)) : nothing;
    });
  }
  return distance;
}

}  // namespace slipwise
