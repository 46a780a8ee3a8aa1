# SPDX-License-Identifier: Apache-2.0
"""slipwise learns a ground robot's motion model while the robot drives."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from slipwise.calibration import Calibration, Settings, load_settings, make_settings
    from slipwise.errors import SlipwiseError
    from slipwise.evaluation.evaluate import EvaluationOptions, evaluate
    from slipwise.evaluation.result import Evaluation
    from slipwise.export import ExportOptions, export_model
    from slipwise.logs.log import Log
    from slipwise.logs.open_log import open_log
    from slipwise.logs.options import LogOptions
    from slipwise.logs.save_log import save_log
    from slipwise.models import Model, load_model
    from slipwise.prediction import Path, predict

__all__ = [
    "Calibration",
    "Evaluation",
    "EvaluationOptions",
    "ExportOptions",
    "Log",
    "LogOptions",
    "Model",
    "Path",
    "Settings",
    "SlipwiseError",
    "calibrate",
    "evaluate",
    "export_model",
    "load_model",
    "load_settings",
    "make_settings",
    "open_log",
    "predict",
    "save_log",
]

#: Where each public name lives. It is imported at its first use, so that the command line starts at once.
_HOMES = {
    "slipwise.calibration": ("Calibration", "Settings", "load_settings", "make_settings"),
    "slipwise.errors": ("SlipwiseError",),
    "slipwise.evaluation": ("Evaluation", "EvaluationOptions", "evaluate"),
    "slipwise.export": ("ExportOptions", "export_model"),
    "slipwise.logs": ("Log", "LogOptions", "open_log", "save_log"),
    "slipwise.models": ("Model", "load_model"),
    "slipwise.prediction": ("Path", "predict"),
}


def calibrate(  # noqa: PLR0913 - options, most of them short for a setting
    log: Log,
    *,
    basis: str | None = None,
    input_name: str | None = None,
    settings: Settings | None = None,
    estimator: str | None = None,
    smooth: bool = False,
) -> Calibration:
    """Learn the motion model of the robot in `log`; see `slipwise.calibration.calibrate`.

    Args:
        log: what `open_log` returned.
        basis: "auto" or a named basis; short for `settings` with that basis.
        input_name: "command" or "wheel"; by default commands where the log has them.
        settings: what to learn and how.
        estimator: "average", "iekf", "delayed-state", "ekf-thesis", "gradient-descent", or "batch", which
            fits all windows at once, off-line; short for `settings` with that estimator.
        smooth: also say what the slip was during each window, given the whole log.

    Raises:
        LogError: the log has no such input, no poses, or no window to learn from.
        SettingsError: the basis or the estimator is unknown.
    """
    from slipwise import calibration

    chosen = (settings or calibration.Settings()).choosing(basis, estimator)
    return calibration.calibrate(log, input_name=input_name, settings=chosen, smooth=smooth)


def __getattr__(name: str) -> Any:
    """Import a public name, or the version, at its first use (PEP 562)."""
    if name == "__version__":
        return import_module("importlib.metadata").version("slipwise")
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(home), name)
    raise AttributeError(f"module 'slipwise' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*globals(), *__all__, "__version__"]
