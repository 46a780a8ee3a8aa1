# SPDX-License-Identifier: Apache-2.0
"""A log with commands and wheel speeds gives one model, which answers from either."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

import slipwise as sw
from slipwise import _core
from slipwise.calibration import Calibration, calibrate
from slipwise.calibration.both_inputs import calibrate_inputs
from slipwise.errors import ModelError
from slipwise.logs import Inputs, Log
from slipwise.models.slip_words import slip_gains

DRIVE = Drive(seconds=90.0, lag=0.3, delay=0.2)


@cache
def learned() -> Calibration:
    return calibrate_inputs(simulated_log(DRIVE))


def with_wheels(log: Log, part: slice) -> Log:
    """Return the log with some of its wheel speeds."""
    run = log.runs[0]
    assert run.wheels is not None
    return replace(log, runs=(replace(run, wheels=run.wheels.select(part)),))


def test_each_input_is_what_is_learned_from_it_alone() -> None:
    log, both = simulated_log(DRIVE), learned().model
    assert both.inputs == ("command", "wheel")
    for name in both.inputs:
        alone = calibrate(log, input=name).model
        assert both.of_input(name).alone.to_yaml() == alone.to_yaml()


def test_a_file_keeps_both(tmp_path: Path) -> None:
    path = learned().model.save(tmp_path / "model.yaml")
    assert sw.load_model(path).to_yaml() == path.read_text(encoding="utf-8")
    assert sw.load_model(path, input="wheels").content.input == "wheel"


def test_the_caller_chooses_what_predictions_take() -> None:
    model, commands = learned().model, np.array([(0.0, 1.0, 0.4)])
    ends = {name: sw.predict(model, commands, horizon=2.0, input=name).end for name in model.inputs}
    assert np.array_equal(ends["command"], sw.predict(model, commands, horizon=2.0).end)
    assert np.array_equal(ends["wheel"], sw.predict(model.of_input("wheel"), commands, horizon=2.0).end)
    assert ends["wheel"][0] > ends["command"][0]  # wheels have no lag and no delay


def test_each_exported_file_takes_the_input_that_it_needs() -> None:
    model, options = learned().model, sw.ExportOptions(ros_distro="lyrical")

    def values(of: sw.Model, target: str) -> object:
        return sw.export_model(of, target, name="m", options=options, force=True).values

    assert values(model, "diff-drive") == values(model.of_input("wheel"), "diff-drive")
    assert values(model, "mppi") == values(model.of_input("command").alone, "mppi")


def test_models_are_compared_from_an_input_that_both_have() -> None:
    log, both = simulated_log(replace(DRIVE, seed=7)), learned().model
    match = sw.compare(both, both.of_input("wheel"), log)
    assert match.evaluation.input == "wheel"
    assert sw.evaluate(log, model=both).input == "command"


def test_a_model_of_one_input_says_that_it_has_no_other() -> None:
    model = learned().model.of_input("wheel")
    with pytest.raises(ModelError, match="learned from wheel speeds, and nothing from commands"):
        model.of_input("command")


def test_wheels_that_teach_nothing_are_said_and_leave_the_commands() -> None:
    log = simulated_log(DRIVE)
    echo = replace(log, runs=tuple(replace(run, wheels=run.commands) for run in log.runs))
    wheels = len(log.runs[0].wheels or ())
    few = with_wheels(log, slice(wheels - 3, wheels))
    alone = calibrate_inputs(log, input="command")
    for given, why in ((echo, "they echo the commands"), (few, "no window")):
        found = calibrate_inputs(given)
        assert found.model.inputs == ("command",), why
        said = [note for note in found.notes if "No model of its own is learned from wheel speeds" in note]
        assert len(said) == 1, found.notes
        assert why in said[0], said
    assert not any("No model of its own" in note for note in alone.notes)


def test_a_model_of_commands_says_why_it_does_not_use_the_wheel_speeds() -> None:
    def said(**settings: object) -> list[str]:
        notes = calibrate(simulated_log(DRIVE), input="command", settings=sw.make_settings(settings)).notes
        return [note for note in notes if note.startswith("From commands, wheel speeds only say how")]

    (left_out,) = said(auto={"structures": ["joint", "baseline"]})
    assert "auto.structures leaves cascaded out" in left_out
    used = calibrate(simulated_log(DRIVE), input="command").model.content.response
    assert bool(said()) != used
    (named,) = said(basis="edd-2", auto={"structures": ["joint"]})
    assert "auto.structures leaves cascaded out" in named


@pytest.mark.parametrize("basis", ["edd-2", "odd-even-10", "auto"])
def test_what_wheels_do_not_reach_of_commands_is_not_taken_for_slip_or_lag(basis: str) -> None:
    slips = replace(DRIVE, basis=_core.named_basis("edd-2"), alpha=(-0.05, -0.25))
    log, reached = simulated_log(slips), 0.8

    def asked(commands: Inputs | None) -> Inputs | None:
        return commands and replace(commands, v=commands.v / reached, omega=commands.omega / reached)

    firmware = replace(log, runs=tuple(replace(run, commands=asked(run.commands)) for run in log.runs))
    model = calibrate(firmware, input="command", settings=sw.make_settings({"basis": basis})).model
    learned = model.parameters
    for name, truth in (("gain_v", reached), ("gain_omega", reached), ("time_constant_v", DRIVE.lag)):
        assert abs(learned[name].value - truth) < 3.0 * learned[name].std + 0.01 * truth, name
        assert learned[name].std < 0.03 * truth
    slip = slip_gains(model)
    for gain, truth in ((slip.speed, 0.95), (slip.yaw_rate, 0.75)):
        assert abs(gain.value - truth) < 3.0 * gain.std + 0.01
