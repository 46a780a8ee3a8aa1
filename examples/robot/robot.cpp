// SPDX-License-Identifier: Apache-2.0
// A robot that learns while it drives, without Python: its loop steers by the learner's odometry, and what was learned
// is saved at the end and loaded at the start. The robot is simulated here; on a real one, `robot.drive` sends the
// command, and measurements are pushed with their own stamps as they come.
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <slipwise/online/motion_learner.hpp>
#include <stdexcept>
#include <string>

namespace {

volatile std::sig_atomic_t stopped = 0;
constexpr double kPeriod = 0.02;  // [s] of the loop

/// Follows commands with a lag of 0.25 s, drives a tenth less far and turns a third less than it is told.
class SimulatedRobot {
 public:
  void drive(const slipwise::BodyTwist& command) {
    v_ += (command.v - v_) * kPeriod / 0.25;
    omega_ += (command.omega - omega_) * kPeriod / 0.25;
    pose_ = compose(pose_, slipwise::exp(Eigen::Vector3d(0.9 * v_, 0.0, omega_ / 1.5) * kPeriod));
  }
  slipwise::MeasuredPose measure(double t) {
    return {.t = t,
            .x = pose_.x + 0.02 * normal_(random_),
            .y = pose_.y + 0.02 * normal_(random_),
            .yaw = slipwise::wrap_angle(pose_.theta + 0.01 * normal_(random_))};
  }
  const slipwise::Pose2& truth() const { return pose_; }

 private:
  double v_ = 0.0, omega_ = 0.0;
  slipwise::Pose2 pose_;
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

/// Towards the corners of a square, one after another; the nearer, the slower.
slipwise::BodyTwist command_to(const slipwise::Pose2& pose, int& corner) {
  const double x = corner % 4 == 1 || corner % 4 == 2 ? 4.0 : 0.0, y = corner % 4 >= 2 ? 4.0 : 0.0;
  const double distance = std::hypot(x - pose.x, y - pose.y);
  corner += distance < 0.4 ? 1 : 0;
  const double turn = slipwise::wrap_angle(std::atan2(y - pose.y, x - pose.x) - pose.theta);
  return {.v = std::fmin(1.0, 0.3 + 0.4 * distance) * std::fmax(0.1, std::cos(turn)),
          .vy = 0.0,
          .omega = std::fmax(-1.2, std::fmin(1.2, 2.0 * turn))};
}

/// Goes on from what was saved, where there is something that this version can read.
slipwise::MotionLearner learner_from(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string saved{std::istreambuf_iterator<char>(file), {}};
  if (!saved.empty()) {
    try {
      slipwise::MotionLearner learner = slipwise::MotionLearner::load(saved);
      std::printf("goes on from %s\n", path.c_str());
      return learner;
    } catch (const std::invalid_argument& problem) {
      std::printf("%s is left aside: %s\n", path.c_str(), problem.what());
    }
  }
  return slipwise::MotionLearner({});  // every setting has a default
}

/// Whole or not at all: a robot may lose its power at any time.
void save(const slipwise::MotionLearner& learner, const std::filesystem::path& path) {
  const std::filesystem::path beside = path.string() + ".new";
  std::ofstream file(beside, std::ios::binary);
  const std::string bytes = learner.save();
  if (file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush()) {
    std::filesystem::rename(beside, path);
  }
}

void show(const slipwise::MotionLearner& learner, const slipwise::Odometry& at, const slipwise::Pose2& truth) {
  std::printf("%6.1f s: x %.2f y %.2f yaw %.2f (+- %.3f m), %.2f m/s %.2f rad/s, %.3f m off;", at.t, at.pose.x,
              at.pose.y, slipwise::wrap_angle(at.pose.theta), std::sqrt(at.covariance(0, 0)), at.twist.v,
              at.twist.omega, std::hypot(at.pose.x - truth.x, at.pose.y - truth.y));
  const slipwise::LearnedModel learned = learner.model();
  const slipwise::Estimate& estimate = learned.known.motion->estimate;
  for (Eigen::Index i = 0; const slipwise::ParameterInfo& parameter : learned.known.motion->model.parameters()) {
    if (parameter.name == "lon.V" || parameter.name == "ang.w") {
      std::printf(" %s %.3f +- %.3f", parameter.name.c_str(), estimate.mean[i], std::sqrt(estimate.covariance(i, i)));
    }
    ++i;
  }
  std::printf("\n");
}

}  // namespace

int main(int count, char** arguments) {
  const std::filesystem::path state = count > 1 ? arguments[1] : "learner.state";
  const int cycles = static_cast<int>((count > 2 ? std::atof(arguments[2]) : 60.0) / kPeriod);
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int) { stopped = 1; });
  }
  slipwise::MotionLearner learner = learner_from(state);
  learner.start_run();
  SimulatedRobot robot;
  int corner = 1;
  for (int i = 0; i < cycles && stopped == 0; ++i) {
    const double t = kPeriod * i;  // on a real robot: sleep until the next cycle, then the stamp of now
    if (i % 3 == 0) {
      learner.push(robot.measure(t));
    }
    const slipwise::Odometry odometry = learner.odometry().value();  // there is a pose from the first cycle on
    const slipwise::BodyTwist command = command_to(odometry.pose, corner);
    if (i % 50 == 49) {
      const slipwise::MotionState motion = learner.motion_monitor();
      std::printf("%s", motion.stuck ? "stuck! " : "");
      show(learner, odometry, robot.truth());
    }
    learner.push(slipwise::CommandSample{{t, command}});
    robot.drive(command);
  }
  save(learner, state);
}
