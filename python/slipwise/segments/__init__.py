# SPDX-License-Identifier: Apache-2.0
"""Windows between measured poses, cut from the runs of a log."""

from slipwise.segments.windows import WindowRules, Windows, cut_windows

__all__ = ["WindowRules", "Windows", "cut_windows"]
