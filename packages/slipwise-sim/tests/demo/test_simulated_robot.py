# SPDX-License-Identifier: Apache-2.0
"""The robot of the live demonstration delivers samples, takes models, and comes to an end."""

from __future__ import annotations

import threading

import pytest

from slipwise.errors import SettingsError
from slipwise.live.outputs import ModelText, Note
from slipwise.live.samples import Command, Pose, Sample, Wheels
from slipwise.live.transport import Transport
from slipwise_sim.demo.simulated_robot import SimulatedRobot
from slipwise_sim.demo.slalom_course import FLOORS, slalom_course

pytest.importorskip("mujoco", reason="simulation needs MuJoCo")

AT_ONCE = 1e6  # times real time: as fast as it goes
SHORT = slalom_course(1, floors=FLOORS[:1], stretch=9.0)


class Listener:
    """Keeps samples, and says when there are enough."""

    def __init__(self, enough: int) -> None:
        self.samples: list[Sample] = []
        self.enough = threading.Event()
        self._wanted = enough

    def __call__(self, sample: Sample) -> None:
        self.samples.append(sample)
        if len(self.samples) >= self._wanted:
            self.enough.set()


def started(wanted: int) -> tuple[SimulatedRobot, Listener]:
    """Return a robot that drives, and who listens to it."""
    robot, listener = SimulatedRobot(rate=AT_ONCE, course=SHORT), Listener(wanted)
    transport: Transport = robot
    transport.subscribe(listener)
    return robot, listener


def test_samples_of_all_kinds_come_until_it_is_closed() -> None:
    robot, listener = started(40)
    assert listener.enough.wait(20.0)
    robot.close()
    robot.close()
    assert {type(sample) for sample in listener.samples} == {Command, Wheels, Pose}
    assert robot.finished
    delivered = len(listener.samples)
    assert robot.notices()[0] == "on gravel, driving by the vendor's constants"
    assert len(listener.samples) == delivered


def test_what_is_no_model_stops_nothing_and_a_faulty_model_is_said() -> None:
    robot, listener = started(40)
    robot.publish(Note(0.0, "hello"))
    assert listener.enough.wait(20.0)
    robot.publish(ModelText(1.0, "slipwise_model: 999\n"))
    said: list[str] = []
    for _ in range(200):
        said += robot.notices()
        if any("model" in text and "999" in text for text in said):
            break
        threading.Event().wait(0.05)
    robot.close()
    assert any("999" in text for text in said)


@pytest.mark.slow
def test_it_finishes_at_the_end_of_its_course() -> None:
    robot, listener = started(10**9)
    while not robot.finished:
        threading.Event().wait(0.1)
    poses = [sample for sample in listener.samples if isinstance(sample, Pose)]
    assert poses[-1].x > 6.0
    assert "at the end" in robot.notices()[-1]
    robot.close()


def test_rates_without_sense_are_refused() -> None:
    for rate in (0.0, -1.0, float("inf"), float("nan")):
        with pytest.raises(SettingsError, match="the rate is"):
            SimulatedRobot(rate=rate)
