# SPDX-License-Identifier: Apache-2.0
"""Files for other tools from a learned model: ros2_control, Nav2, Autoware, PX4, ArduPilot, a C header."""

from slipwise.export.merge import Merged, merge_firmware, merge_parameters, options_of
from slipwise.export.options import ExportOptions
from slipwise.export.targets import TARGETS, Exported, Target, export_model, find_target, refuse_bad_verdict

__all__ = [
    "TARGETS",
    "ExportOptions",
    "Exported",
    "Merged",
    "Target",
    "export_model",
    "find_target",
    "merge_firmware",
    "merge_parameters",
    "options_of",
    "refuse_bad_verdict",
]
