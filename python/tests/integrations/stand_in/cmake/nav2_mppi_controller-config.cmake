# SPDX-License-Identifier: Apache-2.0
# The stand-in for nav2_mppi_controller as a package that CMake finds.
add_library(nav2_mppi_controller::mppi_controller INTERFACE IMPORTED)
target_include_directories(nav2_mppi_controller::mppi_controller INTERFACE "${CMAKE_CURRENT_LIST_DIR}/..")
