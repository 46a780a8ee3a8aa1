// SPDX-License-Identifier: Apache-2.0
// Times the kernel: one linearisation, one IEKF update, and a ten-minute log, for the clock offset and for full
// dynamics.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "slipwise/filter/iekf.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace {

using namespace slipwise;  // NOLINT(google-build-using-namespace)

constexpr double kPeriod = 0.05;   // 20 Hz
constexpr double kMinutes = 10.0;  // of the long log

/// Median time of `runs` calls [us].
template <typename F>
double median_microseconds(int runs, F work) {
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::nth_element(times, times.begin() + runs / 2);
  return times[static_cast<std::size_t>(runs / 2)];
}

InputHistory long_drive() {
  std::vector<double> t, v, vy, omega;
  for (double time = 0.0; time < 60.0 * kMinutes + 1.0; time += kPeriod) {
    t.push_back(time);
    v.push_back(1.0 + 0.5 * std::sin(0.3 * time));
    vy.push_back(0.0);
    omega.push_back(0.6 * std::sin(0.21 * time) + 0.3 * std::cos(1.1 * time));
  }
  return {t, v, vy, omega};
}

Estimate prior_of(const MotionModel& model) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(model.size());
  if (model.learned().dynamics) {
    mean.segment(model.slip_size(), 4) << std::log(0.3), std::log(0.2), std::log(0.1), std::log(0.07);
  }
  return {mean, Eigen::MatrixXd(Eigen::VectorXd::Constant(model.size(), 0.01).asDiagonal())};
}

Segment measured_segment(const MotionModel& model, const InputHistory& inputs, double start, double length) {
  Segment segment{.start = start, .end = start + length};
  Eigen::VectorXd truth = prior_of(model).mean;
  truth.head(model.slip_size()).setConstant(0.05);
  segment.measured = measured_pose(integrate_segment(model, truth, inputs, segment).poses.back());
  return segment;
}

/// Learns from all windows of the long log, noise of slip and poses included; returns the last estimate's first entry.
double calibrate(const MotionModel& model, const InputHistory& inputs, const std::vector<Segment>& segments) {
  const MotionNoise noise{.psd_time = {1e-3, 1e-3, 1e-3}, .pose_std_xy = 0.02, .pose_std_yaw = 0.01};
  Estimate estimate = prior_of(model);
  for (const Segment& segment : segments) {
    const SegmentPath path = integrate_segment(model, estimate.mean, inputs, segment);
    const Eigen::Matrix3d r = slip_covariance(path, noise) + pose_noise_covariance(motion_of(segment.measured), noise);
    estimate = iekf_update(model, estimate, inputs, segment, r).estimate;
  }
  return estimate.mean[0];
}

void report(const char* name, const ActuatorParameters& learned) {
  const MotionModel model(named_basis("odd-even-10"), learned);
  const InputHistory inputs = long_drive();
  const Estimate prior = prior_of(model);
  const Segment window = measured_segment(model, inputs, 10.0, 5.0);
  const Eigen::Matrix3d noise = 1e-3 * Eigen::Matrix3d::Identity();
  double sink = 0.0;
  std::printf("%s, %d parameters\n", name, static_cast<int>(model.size()));
  std::printf("  integrate, 100 steps        %9.2f us\n", median_microseconds(2001, [&] {
                sink += integrate_segment(model, prior.mean, inputs, window).poses.back().x;
              }));
  std::printf("  linearise, 100 steps        %9.2f us\n", median_microseconds(2001, [&] {
                sink += linearize_segment(model, prior.mean, inputs, window).predicted[0];
              }));
  for (const auto& [words, settings] : {std::pair{"2 iterations", IekfSettings{.iterations = 2, .tolerance = 0.0}},
                                        std::pair{"as by default", IekfSettings{}}}) {
    std::printf("  IEKF update, %-13s  %9.2f us\n", words, median_microseconds(2001, [&] {
                  sink += iekf_update(model, prior, inputs, window, noise, settings).nis;
                }));
  }
  for (const double length : {5.0, 1.0}) {
    std::vector<Segment> segments;
    for (double start = 0.3; start + length <= 60.0 * kMinutes; start += length) {
      segments.push_back(measured_segment(model, inputs, start, length));
    }
    const double time = median_microseconds(21, [&] { sink += calibrate(model, inputs, segments); });
    std::printf("  10 minutes, %3d windows     %9.2f ms\n", static_cast<int>(segments.size()), time / 1000.0);
  }
  std::fprintf(stderr, "%s", std::isfinite(sink) ? "" : "not finite\n");
}

}  // namespace

int main() {
  report("slip alone", {});
  report("with clock offset", {.clock_offset = true});
  report("with dynamics and clock offset", {.dynamics = true, .clock_offset = true});
  return 0;
}
