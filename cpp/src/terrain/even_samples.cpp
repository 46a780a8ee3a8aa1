// SPDX-License-Identifier: Apache-2.0
// Linear interpolation between samples, held before the first and after the last.
#include "slipwise/terrain/even_samples.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr double kLongestGap = 5.0;  // sampling periods that a window may be without a sample

}  // namespace

std::optional<Eigen::MatrixXd> even_samples(const Eigen::Ref<const Eigen::VectorXd>& times,
                                            const Eigen::Ref<const SampleRows>& values, double start,
                                            const std::array<double, 2>& seconds_and_rate) {
  const auto [seconds, rate] = seconds_and_rate;
  if (values.rows() != times.size()) {
    throw std::invalid_argument("a stream has one row of values per time");
  }
  const auto count = rate > 0.0 ? static_cast<Eigen::Index>(std::nearbyint(seconds * rate)) : 0;
  if (count < 1) {
    return std::nullopt;
  }
  const double end = start + static_cast<double>(count - 1) / rate;
  const auto after = std::ranges::upper_bound(times, start) - times.begin();
  const Eigen::Index low = std::max<Eigen::Index>(after - 1, 0);
  const Eigen::Index high =
      std::min<Eigen::Index>(std::ranges::lower_bound(times, end) - times.begin() + 1, times.size());
  const double most = kLongestGap / rate;
  if (high - low < 2 || times[low] > start + most || times[high - 1] < end - most) {
    return std::nullopt;
  }
  const auto t = times.segment(low, high - low);
  if ((t.tail(t.size() - 1) - t.head(t.size() - 1)).maxCoeff() > most) {
    return std::nullopt;
  }
  Eigen::MatrixXd found(count, values.cols());
  Eigen::Index next = 1;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = start + static_cast<double>(i) / rate;
    while (next + 1 < t.size() && t[next] <= at) {
      ++next;
    }
    const double part = std::clamp((at - t[next - 1]) / (t[next] - t[next - 1]), 0.0, 1.0);
    const auto before = values.row(low + next - 1);
    found.row(i) = before + part * (values.row(low + next) - before);
  }
  return found;
}

}  // namespace slipwise
