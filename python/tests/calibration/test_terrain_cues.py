# SPDX-License-Identifier: Apache-2.0
"""Labels go with the run of their name at their time, and are known at their window's end."""

from __future__ import annotations

import numpy as np
import pytest
from sample_surfaces import FIRM, LOOSE, floor_log

from slipwise import _core
from slipwise.calibration.learned_sequence import SequenceOptions, check_labels, cues_of, learn_sequence
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.prepared_run import PreparedRun, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.errors import LogError, SettingsError
from slipwise.terrain.label_file import Window


def answer(white: float) -> _core.TerrainAnswer:
    return _core.TerrainAnswer(["brown", "white"], np.array([1.0 - white, white]), 0.0)


def labels(run: PreparedRun, white: float, begin: float | None = None) -> tuple[Window, ...]:
    first, last = run.run.span
    start = np.arange(first if begin is None else begin, last - 5.0, 5.0)
    return tuple(Window(t, t + 5.0, answer(white)) for t in start.tolist())


@pytest.fixture(scope="module")
def drives() -> list[tuple[PreparedRun, ...]]:
    floors = (FIRM, LOOSE, FIRM)
    return [prepare_run(floor_log(floor, seed), "wheel") for seed, floor in enumerate(floors, start=1)]


def test_what_is_said_is_known_at_the_end_of_its_window(drives: list[tuple[PreparedRun, ...]]) -> None:
    run = drives[0][0]
    first, last = run.run.span
    windows = (Window(first - 9.0, first - 4.0, answer(0.9)), Window(first, first + 5.0, answer(0.9)))
    late = Window(last - 1.0, last + 4.0, answer(0.9))
    assert [t for t, _ in cues_of({run.run.name: (*windows, late)}, run)] == [first + 5.0]
    assert cues_of({"another": windows}, run) == ()


def test_labels_of_other_runs_or_times_are_refused(drives: list[tuple[PreparedRun, ...]]) -> None:
    run = drives[0][0]
    with pytest.raises(LogError, match=r"the labels are of runs x, the logs have .*name the runs alike"):
        check_labels({"x": labels(run, 0.9)}, drives[:1])
    with pytest.raises(LogError, match=r"was driven from .* and its labels are from .*by one clock"):
        check_labels({run.run.name: (Window(1e6, 1e6 + 5.0, answer(0.9)),)}, drives[:1])


def test_labels_of_a_run_that_two_logs_have_are_refused(drives: list[tuple[PreparedRun, ...]]) -> None:
    run = drives[0][0]
    with pytest.raises(LogError, match="two logs have a run"):
        check_labels({run.run.name: labels(run, 0.9)}, [drives[0], drives[0]])


@pytest.mark.slow
def test_classes_are_learned_with_their_surfaces(drives: list[tuple[PreparedRun, ...]]) -> None:
    runs = [drive[0] for drive in drives]
    said = {run.run.name: labels(run, 0.1 if k % 2 else 0.9) for k, run in enumerate(runs)}
    learned = learn_sequence(drives, Settings(), (1.0,), options=SequenceOptions(terrain=said))
    firm, loose = learned.learner.surfaces().surfaces
    assert [log.surface for log in learned.logs] == [firm.name, loose.name, firm.name]
    firm_said, loose_said = dict(firm.classes), dict(loose.classes)
    assert firm_said["white"] > 5.0 * firm_said["brown"]
    assert loose_said["brown"] > 5.0 * loose_said["white"]
    assert sum(firm_said.values()) == pytest.approx(2.0)


def test_a_learner_refuses_what_is_no_probability() -> None:
    learner = MotionLearner("wheel", remember=True)
    learner.cue_terrain({"ice": 0.5, "sand": 0.5}, unknown=0.2)
    with pytest.raises(SettingsError, match="add up to 1"):
        learner.cue_terrain({"ice": 0.5, "sand": 0.2})
