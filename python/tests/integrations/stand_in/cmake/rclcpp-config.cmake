# SPDX-License-Identifier: Apache-2.0
# The stand-in for rclcpp as a package that CMake finds.
add_library(rclcpp::rclcpp INTERFACE IMPORTED)
target_include_directories(rclcpp::rclcpp INTERFACE "${CMAKE_CURRENT_LIST_DIR}/..")
