// SPDX-License-Identifier: Apache-2.0
// What a parameter is: its name, unit and meaning, stated once for files, tables and checks.
#pragma once

#include <string>

namespace slipwise {

struct ParameterInfo {
  std::string name;         ///< `ang.w`, `log_time_constant_v`, `clock_offset`, ...
  std::string unit;         ///< SI; logarithms of seconds are in "ln s"
  std::string description;  ///< one plain sentence
};

}  // namespace slipwise
