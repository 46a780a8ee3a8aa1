# SPDX-License-Identifier: Apache-2.0
"""Stamps that are not in seconds are said live as of the same log."""

from __future__ import annotations

from dataclasses import replace

import pytest
from scripted_node import SLIP, Scripted, driven

from slipwise.calibration import make_settings
from slipwise.live.build import build_node
from slipwise.live.clock_watch import PoseSteps
from slipwise.logs.findings.readings import FEWEST_STEPS


def steps_of(seconds: float, count: int = FEWEST_STEPS) -> PoseSteps:
    steps = PoseSteps()
    for k in range(count + 1):
        steps.take(1000.0 + seconds * k)
        steps.take(1000.0)  # out of order
    return steps


def test_a_robot_that_is_measured_every_ten_seconds_at_most_has_seconds() -> None:
    assert steps_of(10.0).found() is None
    found = steps_of(100.0).found()
    assert found is not None
    assert (found.kind, found.sentence, found.spoils) == ("not-in-seconds", "poses are 100 s apart", True)
    assert steps_of(100.0, FEWEST_STEPS - 1).found() is None


def test_a_recording_after_another_adds_no_step() -> None:
    steps = steps_of(100.0, FEWEST_STEPS - 1)
    steps.restart()
    steps.take(1e6)
    assert not steps.enough


@pytest.mark.parametrize("input_name", ["command", "wheel"])
def test_stamps_in_milliseconds_are_said_in_the_words_of_a_log(input_name: str) -> None:
    script = [replace(sample, t=1e3 * sample.t) for sample in driven(SLIP, input_name)]  # type: ignore[type-var]
    transport = Scripted(script)
    build_node(transport, input_name, make_settings({}), run="live").node.run()
    said = [text for text in transport.said if "apart" in text]
    assert len(said) == 1
    assert said[0].endswith(" s apart. Stamps must be in seconds, not in ms, us or ns.")
    assert not any("unknown_after" in text for text in transport.said)
