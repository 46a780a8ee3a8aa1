# SPDX-License-Identifier: Apache-2.0
"""What is in a log, and what could be learned from it."""

from slipwise.inspection.coverage_map import coverage_map
from slipwise.inspection.data_card import Stated
from slipwise.inspection.inspect_log import Inspection, Stream, Timing, inspect_files, inspect_log
from slipwise.inspection.learnability import Learnability, LearnableParameter
from slipwise.inspection.next_drive import next_drive
from slipwise.inspection.shared_set import files_beside, write_beside
from slipwise.inspection.strict_check import Departure, check_strictly

__all__ = [
    "Departure",
    "Inspection",
    "Learnability",
    "LearnableParameter",
    "Stated",
    "Stream",
    "Timing",
    "check_strictly",
    "coverage_map",
    "files_beside",
    "inspect_files",
    "inspect_log",
    "next_drive",
    "write_beside",
]
