# SPDX-License-Identifier: Apache-2.0
"""slipwise learns a ground robot's motion model while the robot drives."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from slipwise.lazy_names import lazy_names

if TYPE_CHECKING:
    from slipwise.api import Calibration, calibrate, compare, evaluate, predict
    from slipwise.calibration import Settings, load_settings, make_settings
    from slipwise.calibration.coming import Coming
    from slipwise.calibration.motion_learner import MotionLearner
    from slipwise.errors import SlipwiseError
    from slipwise.evaluation import Evaluation, EvaluationOptions
    from slipwise.export import ExportOptions, export_model
    from slipwise.logs.log import Log
    from slipwise.logs.open_log import open_log
    from slipwise.logs.options import LogOptions
    from slipwise.logs.save_log import save_log
    from slipwise.models import Model, load_model
    from slipwise.models.summary import Summary, summarise
    from slipwise.prediction import Path

__all__ = [
    "Calibration",
    "Coming",
    "Evaluation",
    "EvaluationOptions",
    "ExportOptions",
    "Log",
    "LogOptions",
    "Model",
    "MotionLearner",
    "Path",
    "Settings",
    "SlipwiseError",
    "Summary",
    "calibrate",
    "compare",
    "evaluate",
    "export_model",
    "load_model",
    "load_settings",
    "make_settings",
    "open_log",
    "predict",
    "save_log",
    "summarise",
]

#: Where each public name lives.
_HOMES = {
    "slipwise.api": ("Calibration", "calibrate", "compare", "evaluate", "predict"),
    "slipwise.calibration": ("Settings", "load_settings", "make_settings"),
    "slipwise.calibration.coming": ("Coming",),
    "slipwise.calibration.motion_learner": ("MotionLearner",),
    "slipwise.errors": ("SlipwiseError",),
    "slipwise.evaluation": ("Evaluation", "EvaluationOptions"),
    "slipwise.export": ("ExportOptions", "export_model"),
    "slipwise.logs": ("Log", "LogOptions", "open_log", "save_log"),
    "slipwise.models": ("Model", "load_model"),
    "slipwise.models.summary": ("Summary", "summarise"),
    "slipwise.prediction": ("Path",),
}

#: What to use in place of names that one might guess.
_HINTS = {
    "load": "load_model for a model file, open_log for a log",
    "read": "open_log",
    "load_log": "open_log",
    "read_log": "open_log",
    "fit": "calibrate",
    "learn": "calibrate",
    "train": "calibrate",
    "export": "export_model",
    "save": "model.save(path), or save_log",
    "Controller": "slipwise.planning.Controller",
    "ReferencePath": "slipwise.planning.ReferencePath",
    "rollout": "slipwise.planning.rollout",
}

_public = lazy_names(__name__, _HOMES, _HINTS)


def __getattr__(name: str) -> Any:
    """Import a public name, or the version, at its first use."""
    if name == "__version__":
        return import_module("importlib.metadata").version("slipwise")
    return _public(name)


def __dir__() -> list[str]:
    """What is public, and nothing that this file needs for itself."""
    return sorted([*__all__, "__version__"])
