# SPDX-License-Identifier: Apache-2.0
# The stand-in for pluginlib as a package that CMake finds.
add_library(pluginlib::pluginlib INTERFACE IMPORTED)
target_include_directories(pluginlib::pluginlib INTERFACE "${CMAKE_CURRENT_LIST_DIR}/..")

function(pluginlib_export_plugin_description_file plugin_category file)
  install(FILES "${file}" DESTINATION "share/${PROJECT_NAME}")
endfunction()
