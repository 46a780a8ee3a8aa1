// SPDX-License-Identifier: Apache-2.0
// Reads model files by yaml-cpp, for C++ programs without Python or ROS.
#include <yaml-cpp/yaml.h>

#include <stdexcept>

#include "slipwise/motion/model_file.hpp"

namespace slipwise {
namespace {

constexpr int kSchema = 5;

template <typename T>
T value_or(const YAML::Node& node, T absent) {
  return node.IsDefined() && !node.IsNull() ? node.as<T>() : absent;
}

ModelFile read(const YAML::Node& root) {
  if (!root.IsMap() || value_or(root["slipwise_model"], 0) != kSchema) {
    throw std::invalid_argument("no model file of schema 5; slipwise.load_model(path).save(path) renews older ones");
  }
  ModelFile file;
  file.input = root["input"].as<std::string>();
  file.good = root["verdict"]["good"].as<bool>();
  const YAML::Node& slip = root["slip"];
  file.basis = slip["basis"].as<std::string>();
  file.lon = slip["lon"].as<std::vector<std::string>>();
  file.lat = slip["lat"].as<std::vector<std::string>>();
  file.ang = slip["ang"].as<std::vector<std::string>>();
  file.learned = {.dynamics = root["dynamics"].as<bool>(),
                  .clock_offset = root["clock_offset"].as<bool>(),
                  .response = value_or(root["response"], false),
                  .sensor_extrinsics = value_or(root["sensor_extrinsics"], false),
                  .delays = value_or(root["delays"], false),
                  .lags = value_or(root["lags"], false),
                  .wheelbase = value_or(root["wheelbase"], 0.0)};
  file.limit_gains = value_or(root["limit_gains"], std::vector<double>{});
  for (const YAML::Node& row : root["parameters"]) {
    file.rows.push_back({row["name"].as<std::string>(), row["stage"].as<std::string>(), row["value"].as<double>()});
  }
  for (const YAML::Node& row : root["covariance"]) {
    for (const YAML::Node& number : row) {
      file.covariance.push_back(number.as<double>());
    }
  }
  return file;
}

}  // namespace

ModelFile ModelFile::parse(const std::string& text) {
  try {
    return read(YAML::Load(text));
  } catch (const YAML::Exception& problem) {
    throw std::invalid_argument(std::string("the text is no model file: ") + problem.what());
  }
}

}  // namespace slipwise
