// SPDX-License-Identifier: Apache-2.0
// Tables of samples as Python hands them over, a row each.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "slipwise/online/force_buffer.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/readings.hpp"

namespace slipwise::bindings {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline void check_columns(const Rows& rows, Eigen::Index columns, const char* what) {
  if (rows.rows() > 0 && rows.cols() != columns) {
    throw std::invalid_argument(std::string(what) + " need rows of " + std::to_string(columns) + " numbers, got " +
                                std::to_string(rows.cols()));
  }
}

inline std::vector<InputSample> samples(const Rows& rows, const char* what) {
  check_columns(rows, 4, what);
  std::vector<InputSample> all;
  all.reserve(static_cast<std::size_t>(rows.rows()));
  for (const auto& row : rows.rowwise()) {
    all.push_back({row[0], {.v = row[1], .vy = row[2], .omega = row[3]}});
  }
  return all;
}

inline std::vector<KnownForce> known_forces(const Rows& rows) {
  check_columns(rows, 3, "forces");
  std::vector<KnownForce> all;
  for (const auto& row : rows.rowwise()) {
    all.push_back({row[0], row[1], row[2]});
  }
  return all;
}

/// \throws std::invalid_argument where no sensor of one number has such a column.
inline std::size_t reading_kind(std::string_view column) {
  const auto found = std::ranges::find(kReadings, column, &ReadingKind::column);
  if (found == kReadings.end()) {
    throw std::invalid_argument("no sensor of one number has a column " + std::string(column));
  }
  return static_cast<std::size_t>(found - kReadings.begin());
}

/// Numbers of such sensors by kind, of rows (t, number) by column.
inline std::array<std::vector<Reading>, kReadingKinds> readings(const std::map<std::string, Rows>& by_column) {
  std::array<std::vector<Reading>, kReadingKinds> all;
  for (const auto& [column, rows] : by_column) {
    check_columns(rows, 2, column.c_str());
    const std::size_t kind = reading_kind(column);
    for (const auto& row : rows.rowwise()) {
      all.at(kind).push_back({.kind = kind, .t = row[0], .value = row[1]});
    }
  }
  return all;
}

}  // namespace slipwise::bindings
