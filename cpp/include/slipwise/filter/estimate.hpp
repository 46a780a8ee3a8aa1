// SPDX-License-Identifier: Apache-2.0
// What every estimator returns: parameters, their covariance, and a status in words.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slipwise {

/// Gaussian posterior about a parameter vector.
struct Estimate {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

enum class Status : std::uint8_t { Converged, Downweighted, Rejected, NotConverged };
constexpr std::size_t enumerators(Status /*type*/) { return 4; }

/// What the status means and what to do about it.
inline std::string_view advice(Status status) {
  switch (status) {
    case Status::Converged:
      return "converged";
    case Status::Downweighted:
      return "the residual was larger than its noise explains and counted for less";
    case Status::Rejected:
      return "the residual was far beyond its noise and was rejected; look for pose jumps or a change of terrain";
    case Status::NotConverged:
      break;
  }
  return "the iterations did not settle; allow more of them, or look for wrong units or swapped columns";
}

}  // namespace slipwise
