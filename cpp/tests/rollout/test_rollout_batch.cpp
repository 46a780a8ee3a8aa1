// SPDX-License-Identifier: Apache-2.0
// Rollouts are what integrate_segment says, in every basis, with every chain, at every instruction level.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "sample_bases.hpp"
#include "slipwise/rollout/rollout_batch.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

TEST_CASE("first") {
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    const MotionModel model(basis, {true, true});
    Eigen::VectorXd parameters(model.size());
    parameters << tests::sample_slip(basis, 31), std::log(0.2), std::log(0.15), std::log(0.13), std::log(0.07), 0.02;
    const std::size_t n = 50, k = 100;
    const double dt = 0.05;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<double> v(n * k), w(n * k);
    for (std::size_t i = 0; i < n * k; ++i) {
      v[i] = uniform(random) * 1.5;
      w[i] = uniform(random);
    }
    const std::vector<RolloutStart> starts{{{1.0, 2.0, 0.5}, {0.3, 0.2}}};
    const RolloutProgram program(model, parameters, {dt, 0.3, -0.2});
    std::vector<double> x(n * k), y(n * k), th(n * k);
    const RolloutBatch<double> batch{n, k, {v.data(), w.data(), 1, static_cast<std::ptrdiff_t>(n)}, starts, {}};
    for (const InstructionLevel level : kInstructionLevels) {
      RolloutOutputs<double> out;
      out.x = x.data();
      out.y = y.data();
      out.theta = th.data();
      rollout_batch(program, batch, out, {1, level});
      double worst = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        std::vector<double> t{-1.0}, tv{0.3}, ty{0.0}, tw{0.2};
        for (std::size_t j = 0; j < k; ++j) {
          t.push_back(static_cast<double>(j) * dt);
          tv.push_back(v[j * n + i]);
          ty.push_back(0.0);
          tw.push_back(w[j * n + i]);
        }
        const auto path = integrate_segment(
            model, parameters, InputTrack(t, tv, ty, tw),
            {.start = 0.0, .end = dt * k, .initial = BodyTwist{0.3, 0.0, 0.2}, .gx = 0.3, .gy = -0.2});
        const Pose2 end = compose(starts[0].pose, path.poses.back());
        worst = std::max({worst, std::hypot(end.x - x[(k - 1) * n + i], end.y - y[(k - 1) * n + i]),
                          std::abs(end.theta - th[(k - 1) * n + i])});
      }
      CHECK(worst < 1e-9);
      MESSAGE(basis.name(), " ", worst);
    }
  }
}

}  // namespace
}  // namespace slipwise
