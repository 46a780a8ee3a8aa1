# SPDX-License-Identifier: Apache-2.0
"""Wheels of another drive than the poses' give no good model, whoever judges it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result
from field.conftest import FieldLog

Slipwise = Callable[..., Result]

SAID = "the wheels do not explain the poses. They explain 8 % of the motion"


@pytest.mark.parametrize(
    "command", [("calibrate", "--no-report"), ("evaluate", "--methods", "auto")], ids=lambda c: c[0]
)
def test_unrelated_wheels_are_said_not_to_explain_the_poses(
    slipwise: Slipwise, field_log: FieldLog, command: tuple[str, ...]
) -> None:
    result = slipwise(command[0], field_log("unrelated_wheels.csv"), *command[1:])
    assert result.code == 1
    assert SAID in " ".join(result.out.split())


def test_a_live_learner_says_so_too(slipwise: Slipwise, field_log: FieldLog, folder: Path) -> None:
    replay = ("live", "--replay", field_log("unrelated_wheels.csv"), "--rate", "0", "-o", "live.yaml")
    slipwise(*replay)
    saved = " ".join((folder / "live.yaml").read_text().split())
    assert SAID in saved
    assert "good: false" in saved
