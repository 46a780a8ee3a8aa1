# SPDX-License-Identifier: Apache-2.0
"""slipwise learns a ground robot's motion model while the robot drives."""

from importlib.metadata import version

from slipwise.calibration import Calibration, Settings, load_settings, make_settings
from slipwise.calibration import calibrate as _calibrate
from slipwise.errors import SlipwiseError
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.logs import Log, LogOptions, open_log, save_log
from slipwise.models import Model, load_model
from slipwise.prediction import Path, predict

__version__ = version("slipwise")

__all__ = [
    "Calibration",
    "Evaluation",
    "EvaluationOptions",
    "Log",
    "LogOptions",
    "Model",
    "Path",
    "Settings",
    "SlipwiseError",
    "calibrate",
    "evaluate",
    "load_model",
    "load_settings",
    "make_settings",
    "open_log",
    "predict",
    "save_log",
]


def calibrate(
    log: Log, *, basis: str | None = None, input_name: str | None = None, settings: Settings | None = None, batch: bool = False
) -> Calibration:
    """Learn the motion model of the robot in `log`; see `slipwise.calibration.calibrate`.

    Args:
        log: what `open_log` returned.
        basis: "auto" or a named basis; short for `settings` with that basis.
        input_name: "command" or "wheel"; by default commands where the log has them.
        settings: what to learn and how.
        batch: fit all windows at once off-line.

    Raises:
        LogError: the log has no such input, no poses, or no window to learn from.
        SettingsError: the basis is unknown.
    """
    chosen = settings or Settings()
    if basis is not None:
        chosen = chosen.model_copy(update={"basis": basis})
    return _calibrate(log, input_name=input_name, settings=chosen, batch=batch)
