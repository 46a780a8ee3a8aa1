# SPDX-License-Identifier: Apache-2.0
"""A node that sends zeros beside the one that drives is found, and no driver that stops by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log, stopped

from slipwise.calibration import calibrate
from slipwise.logs import Inputs, Log
from slipwise.logs.findings.diagnose import diagnose_log
from slipwise.logs.log import Bools, Floats

SOUND = sound_log(replace(SKID_STEERED, seconds=120.0))


def with_commands(log: Log, t: Floats, stands: Bools) -> Log:
    """The log with commands at these stamps [s], exact zeros where it says so, else what was sent before."""
    (run,) = log.runs
    assert run.commands is not None
    held = np.searchsorted(run.commands.t, t, side="right") - 1
    columns = (run.commands.v, run.commands.vy, run.commands.omega)
    v, vy, omega = (np.where(stands, 0.0, column[held]) for column in columns)
    return replace(log, runs=(replace(run, commands=Inputs(t=t, v=v, vy=vy, omega=omega), wheels=None),))


def beside_idle(log: Log, period: float) -> Log:
    """The log with zeros of a second node beside its commands."""
    (run,) = log.runs
    assert run.commands is not None
    given = run.commands.t
    zeros = np.arange(given[0] + 0.013, given[-1], period)
    t = np.concatenate((given, zeros))
    order = np.argsort(t)
    return with_commands(log, t[order], order >= len(given))


@pytest.mark.parametrize("period", [0.02, 0.2, 0.9])
def test_zeros_of_a_second_node_that_the_robot_does_not_obey_are_found(period: float) -> None:
    (found,) = diagnose_log(beside_idle(SOUND, period))
    assert (found.kind, found.spoils) == ("two-sources", True)
    assert found.sentence.startswith("two sources speak on the command topic, first seen in run")
    assert "ros2 topic info -v names the publishers" in found.advice[0]


def test_no_model_of_such_commands_is_good() -> None:
    assert calibrate(with_commands(SOUND, *_own(SOUND))).verdict.good
    verdict = calibrate(beside_idle(SOUND, 0.2)).verdict
    assert not verdict.good
    assert "two sources speak on the command topic" in verdict.sentence


def test_a_driver_that_sends_zeros_in_place_of_commands_is_one_source() -> None:
    t, stands = _own(SOUND)
    stands = np.asarray(np.arange(len(t)) % 4 == 3)
    assert "two-sources" not in {each.kind for each in diagnose_log(with_commands(SOUND, t, stands))}


def test_zeros_to_a_robot_that_stands_are_not_said_to_be_ignored() -> None:
    idle = beside_idle(stopped(SOUND, 0.0), 0.2)
    assert "two-sources" not in {each.kind for each in diagnose_log(idle)}


def _own(log: Log) -> tuple[Floats, Bools]:
    (run,) = log.runs
    assert run.commands is not None
    return run.commands.t, np.zeros(len(run.commands), bool)
