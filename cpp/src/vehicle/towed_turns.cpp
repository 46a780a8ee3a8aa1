// SPDX-License-Identifier: Apache-2.0
// How trailers turn behind a robot that is known by its steps.
#include "slipwise/vehicle/towed_turns.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <stdexcept>

namespace slipwise {

Eigen::MatrixXd towed_turns(const Eigen::Ref<const Eigen::VectorXd>& forward,
                            const Eigen::Ref<const Eigen::VectorXd>& rotation, std::span<const Trailer> trailers,
                            double most_folded, int parts) {
  if (forward.size() != rotation.size()) {
    throw std::invalid_argument("each step needs a way and a turn");
  }
  const auto long_enough = [](const Trailer& trailer) { return trailer.length > 0.0; };
  if (parts < 1 || !(most_folded >= 0.0) || !std::ranges::all_of(trailers, long_enough)) {
    throw std::invalid_argument(
        "a trailer needs a length above 0, a fold of 0 or more, and steps of at least one part");
  }
  Eigen::MatrixXd turned(forward.size(), std::ssize(trailers));
  for (Eigen::Index column = 0; column < turned.cols(); ++column) {
    const Trailer& trailer = trailers[static_cast<std::size_t>(column)];
    double fold = 0.0;
    for (Eigen::Index step = 0; step < turned.rows(); ++step) {
      const double pulled = forward[step] / parts / trailer.length;
      const double turn = trailer.turn * rotation[step] / parts;
      double sum = 0.0;
      for (int part = 0; part < parts; ++part) {
        const double follows = pulled * std::sin(fold) - trailer.behind * turn * std::cos(fold);
        fold = std::clamp(fold + turn - follows, -most_folded, most_folded);
        sum += follows;
      }
      turned(step, column) = sum;
    }
  }
  return turned;
}

}  // namespace slipwise
