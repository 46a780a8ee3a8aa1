// SPDX-License-Identifier: Apache-2.0
// Drives the plug-in as Nav2 would: commands that were published, then samples; prints what it fills in.
#include <cstdio>

#include "learned_motion_model.cpp"

int main() {
  constexpr int kRollouts = 3, kPeriods = 12;
  mppi::ParametersHandler parameters;
  PluginOfTest plugin;
  plugin.initialize(&parameters, "FollowPath.learned");
  plugin.setDelays(0.05F, 0.2F, 0.1F);
  for (int i = 0; i < 6; ++i) {
    plugin.pushCommandHistory(0.1F * static_cast<float>(i), -0.05F * static_cast<float>(i));
  }
  mppi::models::State state;
  for (Eigen::ArrayXXf* each : {&state.vx, &state.vy, &state.wz, &state.cvx, &state.cvy, &state.cwz}) {
    each->setZero(kRollouts, kPeriods);
  }
  for (int n = 0; n < kRollouts; ++n) {
    for (int k = 0; k < kPeriods; ++k) {
      state.cvx(n, k) = 0.5F + 0.02F * static_cast<float>(n * k);
      state.cwz(n, k) = 0.1F * static_cast<float>(n - 1);
    }
  }
  state.speed.linear.x = 0.3;
  state.speed.angular.z = -0.1;
  mppi::MotionModel& model = plugin;
  model.predict(state);
  std::printf("%d\n", model.isHolonomic() ? 1 : 0);
  for (int n = 0; n < kRollouts; ++n) {
    for (int k = 0; k < kPeriods; ++k) {
      std::printf("%.7g %.7g %.7g\n", static_cast<double>(state.vx(n, k)), static_cast<double>(state.vy(n, k)),
                  static_cast<double>(state.wz(n, k)));
    }
  }
  return 0;
}
