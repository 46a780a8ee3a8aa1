// SPDX-License-Identifier: Apache-2.0
// Times the motion model of Nav2's MPPI controller, restated: Eigen arrays over rollouts and periods, Euler steps with
// the heading before the step, no slip.
#if defined(__x86_64__)
#pragma GCC target("arch=x86-64-v3")  // what Nav2 is built for at best
#endif
#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>

namespace {

constexpr Eigen::Index kRollouts = 2048;
constexpr Eigen::Index kPeriods = 100;
constexpr float kPeriod = 0.05F;  // [s]
constexpr int kRuns = 100;

using Table = Eigen::ArrayXXf;  // one row a rollout, one column a period

/// Written again by every run, so that no run waits for memory.
struct Trajectories {
  Table x{kRollouts, kPeriods};
  Table y{kRollouts, kPeriods};
  Table yaw{kRollouts, kPeriods};
  Table cosine{kRollouts, kPeriods};
  Table sine{kRollouts, kPeriods};
};

/// Headings are sums of turns; positions are sums of the speeds, turned by the heading before each step.
void integrate(const Table& v, const Table& omega, Trajectories& path) {
  path.yaw.col(0) = omega.col(0) * kPeriod;
  for (Eigen::Index k = 1; k < kPeriods; ++k) {
    path.yaw.col(k) = path.yaw.col(k - 1) + omega.col(k) * kPeriod;
  }
  Table& cosine = path.cosine;
  Table& sine = path.sine;
  cosine.col(0).setOnes();
  sine.col(0).setZero();
  cosine.rightCols(kPeriods - 1) = path.yaw.leftCols(kPeriods - 1).cos();
  sine.rightCols(kPeriods - 1) = path.yaw.leftCols(kPeriods - 1).sin();
  path.x.col(0) = v.col(0) * cosine.col(0) * kPeriod;
  path.y.col(0) = v.col(0) * sine.col(0) * kPeriod;
  for (Eigen::Index k = 1; k < kPeriods; ++k) {
    path.x.col(k) = path.x.col(k - 1) + v.col(k) * cosine.col(k) * kPeriod;
    path.y.col(k) = path.y.col(k - 1) + v.col(k) * sine.col(k) * kPeriod;
  }
}

}  // namespace

int main() {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  const Table v = 1.0F + 0.7F * Table::NullaryExpr(kRollouts, kPeriods, [&] { return uniform(random); });
  const Table omega = 0.6F * Table::NullaryExpr(kRollouts, kPeriods, [&] { return uniform(random); });
  Trajectories path;
  double best = 1e9;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    integrate(v, omega, path);
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::printf("MPPI motion model, Eigen arrays, Euler steps, all poses: %.3f e9 steps/s (x of the last: %.3f)\n",
              static_cast<double>(kRollouts * kPeriods) / best / 1e9, static_cast<double>(path.x(0, kPeriods - 1)));
  return 0;
}
