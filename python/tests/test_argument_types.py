# SPDX-License-Identifier: Apache-2.0
"""Public functions say what they were given where it is of another kind, and take all kinds of numbers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from sample_models import make_model, named

import slipwise as sw
from slipwise.argument_types import check_arguments
from slipwise.errors import SettingsError
from slipwise.planning import load_map, rollout, trajectory_to

MODEL = make_model(named("edd-2"))
COMMANDS = [(0.0, 0.5, 0.1)]
WRONG = cast("Any", None)
CASES: dict[str, tuple[Callable[[], object], str]] = {
    "a log": (lambda: sw.calibrate(WRONG), r"^log is None \(calibrate\(\)\): give a Log, a path or a list$"),
    "logs": (lambda: sw.evaluate(cast("Any", [3])), r"^log is \[3\] \(evaluate\(\)\): "),
    "settings": (
        lambda: sw.calibrate("x.csv", settings=cast("Any", {})),
        r"^settings is of type dict \(calibrate\(\)\): give a Settings or None$",
    ),
    "a horizon": (
        lambda: sw.predict(MODEL, COMMANDS, horizon=cast("Any", "5")),
        r"^horizon is '5' \(predict\(\)\): give a number$",
    ),
    "a flag": (lambda: sw.predict(MODEL, COMMANDS, horizon=True), r"^horizon is True \(predict\(\)\): "),
    "speeds": (
        lambda: sw.predict(MODEL, COMMANDS, horizon=1.0, initial=cast("Any", (0.1, "a"))),
        r"^initial is \(0.1, 'a'\) \(predict\(\)\): give numbers or None$",
    ),
    "a pose": (
        lambda: sw.predict(MODEL, COMMANDS, horizon=1.0, at=cast("Any", (0.0, 0.0))),
        r"^at is \(0.0, 0.0\) \(predict\(\)\): give 3 numbers$",
    ),
    "a ground": (
        lambda: sw.predict(MODEL, COMMANDS, horizon=1.0, ground=cast("Any", 0.1)),
        r"^ground is 0.1 \(predict\(\)\): give a Ground or None$",
    ),
    "models": (
        lambda: sw.compare(WRONG, MODEL, "x.csv"),
        r"^old is None \(compare\(\)\): give a Model or a path",
    ),
    "a path": (lambda: sw.open_log(WRONG), r"^paths is None \(open_log\(\)\): give a path$"),
    "where to save": (lambda: MODEL.save(WRONG), r"^path is None \(Model.save\(\)\): give a path$"),
    "a saved learner": (
        lambda: sw.MotionLearner.load(WRONG),
        r"^saved is None \(MotionLearner.load\(\)\): give bytes$",
    ),
    "a map": (lambda: load_map(WRONG), r"^path is None \(load_map\(\)\): give a path$"),
    "a model file": (lambda: sw.load_model(WRONG), r"^path is None \(load_model\(\)\): give a path$"),
    "a table": (lambda: sw.make_settings(WRONG), r"^content is None \(make_settings\(\)\): give a dict$"),
    "a summary": (lambda: sw.summarise(WRONG), r"^model is None \(summarise\(\)\): give a Model$"),
    "an option": (
        lambda: sw.ExportOptions(horizon=cast("Any", "1")),
        r"^horizon is '1' \(ExportOptions\(\)\): give a number$",
    ),
    "a target": (
        lambda: sw.export_model(MODEL, WRONG, name="x"),
        r"^target is None \(export_model\(\)\): give text$",
    ),
    "a log to save": (lambda: sw.save_log(WRONG, "x.csv"), r"^log is None \(save_log\(\)\): give a Log$"),
    "a goal": (
        lambda: trajectory_to(MODEL, WRONG),
        r"^the goal is not a pose \(None\): give finite",
    ),
    "a planner": (
        lambda: trajectory_to(WRONG, (1.0, 0.0, 0.0)),
        r"^model is None \(Planner\(\)\): give a Model$",
    ),
    "a period": (
        lambda: rollout(MODEL, np.zeros((1, 3, 2)), cast("Any", "a")),
        r"^dt is 'a' \(rollout\(\)\): give a number$",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_what_is_of_another_kind_is_said(case: str) -> None:
    call, message = CASES[case]
    with pytest.raises(SettingsError, match=message):
        call()


def test_numbers_lists_and_paths_of_every_kind_are_taken(tmp_path: Path) -> None:
    exact = sw.predict(MODEL, COMMANDS, horizon=2.0, initial=(0.5, 0.1))
    alike = sw.predict(
        MODEL,
        np.array(COMMANDS),
        horizon=np.int64(2),
        start=np.float32(0.0),
        initial=cast("Any", np.array([0.5, 0.1])),
        at=cast("Any", [0, 0, 0]),
    )
    np.testing.assert_array_equal(alike.poses, exact.poses)
    MODEL.save(tmp_path / "model.yaml")
    assert (
        sw.load_model(str(tmp_path / "model.yaml")).content == sw.load_model(tmp_path / "model.yaml").content
    )


def test_every_kind_of_annotation_is_checked() -> None:
    def function(several: list[int], often: Callable[[], None] | None, whole: int = 1) -> None: ...

    check_arguments(function, {"several": [1], "often": print, "whole": np.int8(3)})
    for wrong in ({"several": (1,)}, {"often": 3}, {"whole": 1.5}, {"whole": True}):
        with pytest.raises(SettingsError, match=rf"^{next(iter(wrong))} is "):
            check_arguments(function, {"several": [], "often": None, "whole": 1} | wrong)
