# SPDX-License-Identifier: Apache-2.0
"""Too few segments: what was rejected, an input that has enough, and how much driving it takes."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_logs import Drive, inputs_until, simulated_log

from slipwise.calibration import calibrate, make_settings
from slipwise.errors import LogError
from slipwise.logs import Log

EDD_2 = make_settings({"basis": "edd-2"})


def advice_of(log: Log, input_name: str) -> str:
    verdict = calibrate(log, input=input_name, settings=EDD_2).verdict
    assert not verdict.good
    return " ".join(verdict.advice)


def test_an_input_that_has_enough_is_proposed_and_never_the_one_in_use() -> None:
    log = simulated_log(Drive(seconds=40.0))
    run = log.runs[0]
    assert run.commands is not None
    short = replace(log, runs=(replace(run, commands=inputs_until(run.commands, 4.0)),))
    assert "From wheel speeds the log has 40 segments: use --input wheel." in advice_of(short, "command")
    both = simulated_log(Drive(seconds=4.0))
    for name in ("command", "wheel"):
        assert "--input" not in advice_of(both, name)


def test_what_was_rejected_is_named_with_its_cure() -> None:
    log = simulated_log(Drive(seconds=40.0))
    run = log.runs[0]
    assert run.wheels is not None
    driven = run.wheels.t < 4.0
    parked = replace(run.wheels, v=run.wheels.v * driven, omega=run.wheels.omega * driven)
    advice = advice_of(replace(log, runs=(replace(run, wheels=parked, commands=None),)), "wheel")
    assert (
        "Rejected: 36 x the robot was commanded to stand still for the whole segment; drive for more"
        in advice
    )
    assert "at the very least 8 segments of 1 s, where this log has 4." in advice


def test_a_log_without_any_input_does_not_propose_the_other_one() -> None:
    run = replace(simulated_log(Drive(seconds=20.0)).runs[0], commands=None, wheels=None)
    for name in (None, "command", "wheel"):
        with pytest.raises(LogError, match=r"no commands and no wheel speeds: record") as caught:
            calibrate(Log(runs=(run,)), input=name)
        assert "--input" not in str(caught.value)
