# SPDX-License-Identifier: Apache-2.0
"""No argument ends the interpreter, hangs or is read beyond its end: wrong shapes throw, in every binding."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bindings.sound_arguments import of_type, owner_of, sound
from bindings.stub_calls import bound_functions, compiled

from slipwise import _core

PART = 30  # functions to a process
STATE = _core.SlipState(1.0, 0.2, 0.0, 0.0)
EDD_2 = _core.named_basis("edd-2")
MODEL = _core.MotionModel(EDD_2, False, True)


def test_a_covariance_of_another_size_is_refused(subtests: pytest.Subtests) -> None:
    for shape in [(0, 0), (0, 1), (1, 1), (2, 3), (3, 3)]:
        with subtests.test(shape=shape):
            with pytest.raises(ValueError, match="the covariance of slip rates needs 2 rows and columns"):
                _core.slip_rate_covariance(EDD_2, np.zeros(shape), STATE)
            law = _core.DisturbanceModel([], np.zeros(0))
            with pytest.raises(ValueError, match="the covariance of a model needs 3 rows and columns"):
                _core.covariance_over(MODEL, np.zeros((shape[0] + 1, shape[1] + 2)), law, np.ones(3), 1.0)


@pytest.mark.parametrize("count", [0, 1, 3, 1000])
def test_parameters_of_another_number_are_refused(count: int) -> None:
    with pytest.raises(ValueError, match=f"a slip rate needs 2 numbers, got {count}"):
        _core.slip_rate(EDD_2, np.zeros(count), STATE)
    with pytest.raises(ValueError, match=f"takes 3 parameters, got {count + 1 if count == 3 else count}"):
        MODEL.actuator(np.zeros(count + 1 if count == 3 else count))


def test_pairs_of_a_matrix_that_is_no_covariance_are_refused() -> None:
    with pytest.raises(ValueError, match="a covariance needs 3 rows and columns, got 3 by 10"):
        _core.correlated_pairs(np.zeros((3, 10)), 1.0)


def test_a_list_of_inputs_in_which_one_is_missing_is_refused() -> None:
    segment, noise = [of_type("Segment")], [np.eye(3)]
    settings = (_core.DriftSettings(), _core.IekfSettings())
    with pytest.raises(ValueError, match="each segment needs inputs, got None"):
        _core.rts_smooth(MODEL, of_type("Estimate"), [None], segment, noise, *settings)  # type: ignore[list-item]


def test_a_run_without_poses_may_be_of_a_log_that_tells_sources_apart() -> None:
    nothing = [np.zeros((0, columns)) for columns in (4, 4, 3, 9)]
    assert len(_core.cut_segments(_core.StreamSettings(), [_core.Recording(*nothing)]).segments) == 0
    wrong = np.zeros((1, 9))
    wrong[0, 7] = -1.0
    with pytest.raises(ValueError, match="numbers of sources and fixes must be 0 or more"):
        _core.Recording(*nothing[:3], wrong)


@pytest.mark.parametrize("stamps", [(5.95, 5.95), (float("nan"), 6.0), (6.1, 6.0)])
def test_stamps_of_future_inputs_that_do_not_increase_are_refused(stamps: tuple[float, float]) -> None:
    future = np.column_stack((stamps, np.zeros((2, 3))))
    with pytest.raises(ValueError, match="their stamps must increase"):
        of_type("MotionLearner").predict(future, 1.0, 0.0, np.zeros((0, 3)), None)


def test_every_binding_works_with_its_sound_arguments(subtests: pytest.Subtests) -> None:
    """What the test below changes one by one; a new binding may need a line in `sound_arguments`."""
    for number in range(len(bound_functions())):
        with subtests.test(number=number):
            bound = bound_functions()[number]
            given = [sound(bound, *parameter) for parameter in bound.parameters]
            if bound.title == "Gpu.__init__":
                pytest.skip("there may be no GPU")
            if bound.name == "__init__":
                compiled(bound.owner)(*given)
            elif bound.owner:
                getattr(owner_of(bound), bound.name)(*given)
            else:
                compiled(bound.name)(*given)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, len(bound_functions()), PART))
def test_no_wrong_argument_ends_the_interpreter(first: int) -> None:
    script = Path(__file__).with_name("hostile_arguments.py")
    done = subprocess.run(
        [sys.executable, str(script), str(first), str(first + PART)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    lines = done.stdout.splitlines()
    assert done.returncode == 0, f"ended with {done.returncode} at: {lines[-1:]}\n{done.stderr[-2000:]}"
    assert lines[lines.index("-" * 20) + 1 :] == []
