// SPDX-License-Identifier: Apache-2.0
// A stand-in: the plug-in's class under a name that the test's program makes it by.
#pragma once

#define PLUGINLIB_EXPORT_CLASS(plugin, base) using PluginOfTest = plugin;
