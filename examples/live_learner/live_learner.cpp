// SPDX-License-Identifier: Apache-2.0
// Learns from commands and poses one measurement at a time, as a robot does; here from a tidy log on standard input.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <slipwise/online/motion_learner.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace {

std::vector<std::string> cells(std::string line) {
  std::erase(line, '"');
  std::vector<std::string> found;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    found.push_back(cell);
  }
  return found;
}

}  // namespace

int main() {
  std::string line;
  std::getline(std::cin, line);
  const std::vector<std::string> names = cells(line);
  slipwise::MotionLearner learner({});  // every setting has a default
  slipwise::InputSample command{};
  while (std::getline(std::cin, line)) {
    std::map<std::string, double> row;
    const std::vector<std::string> values = cells(line);
    for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
      if (!values[i].empty()) {
        row[names[i]] = std::strtod(values[i].c_str(), nullptr);
      }
    }
    if (row.contains("cmd_v") && row.contains("cmd_omega")) {
      command = {row["t"], {row["cmd_v"], 0.0, row["cmd_omega"]}};
      learner.push(slipwise::CommandSample{{command.t, command.twist}});
    }
    if (row.contains("x") && row.contains("y") && row.contains("yaw")) {
      learner.push(slipwise::MeasuredPose{row["t"], row["x"], row["y"], row["yaw"]});
    }
    for (const slipwise::LearnerEvent& event : learner.events()) {
      if (event.kind == slipwise::LearnerEvent::Kind::TerrainChange) {
        std::printf("%.1f s: the terrain changed\n", event.t);
      }
    }
  }
  const slipwise::LearnedModel learned = learner.model();
  const slipwise::Estimate& estimate = learned.known.motion->estimate;
  for (Eigen::Index i = 0; const slipwise::ParameterInfo& parameter : learned.known.motion->model.parameters()) {
    std::printf("%-18s %8.4f +- %.4f\n", parameter.name.c_str(), estimate.mean[i],
                std::sqrt(estimate.covariance(i, i)));
    ++i;
  }
  const slipwise::PredictedPath path = learner.predict({{learner.newest(), command.twist}}, 5.0);
  std::printf("%zu segments; 5 s ahead, the last command held: x %.3f m +- %.3f, y %.3f m +- %.3f\n", learned.segments,
              path.poses.back().x(), std::sqrt(path.covariances.back()(0, 0)), path.poses.back().y(),
              std::sqrt(path.covariances.back()(1, 1)));
}
