# SPDX-License-Identifier: Apache-2.0
"""What is in a log, and what could be learned from it."""

from slipwise.inspection.coverage_map import coverage_map
from slipwise.inspection.inspect_log import Inspection, inspect_files, inspect_log
from slipwise.inspection.learnability import Learnability, LearnableParameter
from slipwise.inspection.streams import Stream
from slipwise.inspection.timing import Timing

__all__ = [
    "Inspection",
    "Learnability",
    "LearnableParameter",
    "Stream",
    "Timing",
    "coverage_map",
    "inspect_files",
    "inspect_log",
]
