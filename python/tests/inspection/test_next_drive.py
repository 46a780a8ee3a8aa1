# SPDX-License-Identifier: Apache-2.0
"""The drive that a log calls for stays within its speeds, and is refused where these are not known."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.errors import SettingsError
from slipwise.excitation import ExcitationOptions, command_inputs
from slipwise.inspection import inspect_log, next_drive

FEW = ExcitationOptions(minutes=0.5, levels=3, robots=25, checked=200)
SLIP = {"basis": _core.named_basis("edd-2"), "alpha": (-0.1, -0.3)}


@pytest.mark.slow
def test_the_drive_is_no_faster_than_the_log() -> None:
    log = simulated_log(Drive(seconds=40.0, speeds=(0.2, 0.8), yaw_rates=(-0.4, 0.4), **SLIP))  # type: ignore[arg-type]
    done: list[float] = []
    drive = next_drive(log, FEW, progress=done.append)
    inputs, driven = command_inputs(drive), log.runs[0].commands
    assert driven is not None
    assert np.abs(inputs.v).max() <= np.abs(driven.v).max() + 1e-9
    assert np.abs(inputs.omega).max() <= np.abs(driven.omega).max() + 1e-9
    assert np.abs(inputs.v).max() > 0.1
    assert done


@pytest.mark.slow
def test_what_inspect_learned_is_not_learned_again(monkeypatch: pytest.MonkeyPatch) -> None:
    log = simulated_log(Drive(seconds=40.0, **SLIP))  # type: ignore[arg-type]
    plain, keeping = inspect_log(log), inspect_log(log, keep=True)
    assert plain.kept is None
    assert keeping.learned == plain.learned
    learned = next_drive(log, FEW)
    monkeypatch.setattr(sys.modules["slipwise.inspection.next_drive"], "calibrate", None)
    kept = next_drive(log, FEW, kept=keeping.kept)
    assert kept.moves == learned.moves
    assert np.array_equal(kept.knowledge.covariance, learned.knowledge.covariance)


def test_nothing_is_kept_where_calibrate_learns_another_way() -> None:
    log = simulated_log(Drive(seconds=20.0, **SLIP))  # type: ignore[arg-type]
    assert inspect_log(log, Settings(estimator="iekf"), keep=True).kept is None


def test_of_wheels_alone_the_prior_says_what_commands_do(monkeypatch: pytest.MonkeyPatch) -> None:
    module = sys.modules["slipwise.inspection.next_drive"]
    monkeypatch.setattr(module, "design_drive", lambda known, *_, **__: known)
    log = simulated_log(Drive(seconds=40.0, **SLIP))  # type: ignore[arg-type]
    wheels = replace(log, runs=tuple(replace(run, commands=None) for run in log.runs))
    of_commands, of_wheels = (next_drive(each, FEW) for each in (log, wheels))
    assert "log_delay_v" in of_wheels.names
    assert of_wheels.covariance[0, 0] > 10.0 * of_commands.covariance[0, 0]


@pytest.mark.slow
def test_a_log_that_never_turns_shows_no_limit() -> None:
    log = simulated_log(Drive(seconds=40.0, yaw_rates=(0.0, 0.0), **SLIP))  # type: ignore[arg-type]
    with pytest.raises(SettingsError, match=r"without turning .*--excite.*slipwise excite --speed"):
        next_drive(log, FEW)
