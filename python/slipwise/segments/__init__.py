# SPDX-License-Identifier: Apache-2.0
"""Windows between measured poses, cut from the runs of a log."""

from slipwise.segments.windows import RECENT, WindowRules, Windows, cut_windows, pose_intervals

__all__ = ["RECENT", "WindowRules", "Windows", "cut_windows", "pose_intervals"]
