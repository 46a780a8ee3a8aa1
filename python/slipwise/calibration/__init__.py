# SPDX-License-Identifier: Apache-2.0
"""Learning a motion model from a log."""

from slipwise.calibration.calibrate import calibrate
from slipwise.calibration.result import Calibration, History, Verdict
from slipwise.calibration.settings import Settings, load_settings, make_settings

__all__ = ["Calibration", "History", "Settings", "Verdict", "calibrate", "load_settings", "make_settings"]
