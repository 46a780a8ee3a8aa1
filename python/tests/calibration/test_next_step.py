# SPDX-License-Identifier: Apache-2.0
"""After a verdict the next command is named, or the driving that is missing."""

from __future__ import annotations

from pathlib import Path

from slipwise.calibration import Verdict
from slipwise.calibration.next_step import after_checking, after_learning


def test_a_good_model_is_checked_on_another_day_and_then_exported() -> None:
    lines = after_learning(Verdict(True, "Fine."), Path("my model.yaml"))
    assert lines[1:] == (
        "  slipwise evaluate OTHER_LOG --model 'my model.yaml'",
        "  slipwise export 'my model.yaml' --to all -o config",
    )


def test_a_model_that_was_checked_is_exported() -> None:
    assert after_checking(Verdict(True, "Fine."), Path("m.yaml"))[1:] == (
        "  slipwise export m.yaml --to all -o config",
    )


def test_a_bad_model_leads_to_the_driving_that_is_missing_or_to_none() -> None:
    missing = Verdict(False, "No.", advice=("Turn on the spot.",))
    assert "calibrate again" in after_learning(missing, Path("m.yaml"))[0]
    line = after_checking(Verdict(False, "No."), Path("m.yaml"))[0]
    assert "use commands or wheel speeds as they are" in line
