# SPDX-License-Identifier: Apache-2.0
"""What goes wrong while it runs is said once, counted and survived, and moves no parameter."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scripted_node import Scripted, driven, run_node

from slipwise.calibration import Settings
from slipwise.calibration.live_table import LiveTable
from slipwise.live.build import Built, build_node
from slipwise.live.gates import RECOVERY
from slipwise.live.samples import Command, Override, Pose, Sample, Wheels
from slipwise.models import Model

BEGIN, END = 45.0, 55.0  # s; the drive goes on until 90 s
pytestmark = pytest.mark.slow


def stamped(sample: Sample) -> float:
    assert isinstance(sample, Command | Wheels | Pose)
    return sample.t


@cache
def drive() -> tuple[Sample, ...]:
    return tuple(driven())


def without_poses(begin: float, end: float) -> list[Sample]:
    return [s for s in drive() if not (isinstance(s, Pose) and begin <= s.t < end)]


def learned(built: Built) -> Model:
    return built.learning.learner.model(limits=False)


@cache
def reference(begin: float = 0.0, end: float = 0.0) -> Model:
    built, _ = run_node(without_poses(begin, end))
    return learned(built)


def farthest(found: Model, wanted: Model) -> float:
    """The largest difference of a parameter, in its standard deviations."""
    assert [p.name for p in found.content.parameters] == [p.name for p in wanted.content.parameters]
    return float(np.max(np.abs(found.mean - wanted.mean) / np.sqrt(np.diag(wanted.covariance))))


def check_said_once(transport: Scripted, text: str) -> None:
    assert sum(text in said for said in transport.said) == 1, transport.said


def test_numbers_that_are_none_are_counted_and_change_nothing() -> None:
    script: list[Sample] = []
    for k, sample in enumerate(drive()):
        script.append(sample)
        if k % 50 == 0:
            t = stamped(sample)
            script += [Pose(t, math.nan, 0.0, 0.0), Wheels(t, math.inf, math.nan), Wheels(math.nan, 1.0, 0.0)]
    built, transport = run_node(script)
    assert learned(built).content == reference().content
    assert transport.statuses[-1].counts["a number is missing or impossible"] >= 3 * (len(drive()) // 50)


def test_ten_times_the_rate_changes_little() -> None:
    script: list[Sample] = []
    for sample in drive():
        script.append(sample)
        if not isinstance(sample, Pose) and BEGIN <= stamped(sample) < END:
            script += [replace(sample, t=stamped(sample) + 0.005 * k) for k in range(1, 10)]
    built, _ = run_node(script)
    assert farthest(learned(built), reference()) <= 0.1


@pytest.mark.parametrize("what", ["pose", "wheels"])
def test_a_topic_that_stops_and_returns_moves_nothing(what: str) -> None:
    stopped = Pose if what == "pose" else Wheels
    script = [s for s in drive() if not (isinstance(s, stopped) and BEGIN <= stamped(s) < END)]
    before, _ = run_node([s for s in script if stamped(s) < BEGIN + 5.0])
    back, _ = run_node([s for s in script if stamped(s) < END + 0.9])  # no segment is complete yet
    assert farthest(learned(back), learned(before)) <= 0.1
    built, transport = run_node(script)
    assert built.learning.segments > back.learning.segments + 10
    assert not [said for said in transport.said if "stuck" in said]


def test_a_clock_that_jumps_back_by_an_hour_begins_a_new_run() -> None:
    late = [replace(s, t=stamped(s) + 3600.0) if stamped(s) < BEGIN else s for s in drive()]  # type: ignore[type-var]
    built, transport = run_node(late)
    check_said_once(transport, "the clock was set back by 3")
    assert transport.statuses[-1].counts["the clock was set back"] == 1
    before, _ = run_node([s for s in late if stamped(s) >= 3600.0])
    after, _ = run_node([s for s in late if stamped(s) >= 3600.0 or BEGIN <= stamped(s) < BEGIN + 0.2])
    assert farthest(learned(after), learned(before)) <= 0.1
    assert built.learning.segments > after.learning.segments + 10


def second_robot(what: str) -> Iterable[Sample]:
    rng = np.random.default_rng(5)
    for sample in drive():
        yield sample
        t = stamped(sample)
        if not BEGIN <= t < END:
            continue
        if what == "pose" and isinstance(sample, Pose):
            x, y = rng.normal((30.0 + 0.3 * (t - BEGIN), -12.0), 0.01)
            yield Pose(t + 0.01, float(x), float(y), 1.0)
        if what == "wheels" and isinstance(sample, Wheels):
            yield Wheels(t + 0.01, 1.4 - sample.v, 0.9)


@pytest.mark.parametrize("what", ["pose", "wheels"])
def test_a_second_robot_on_the_same_topic_teaches_nothing(what: str) -> None:
    _, transport = run_node(list(second_robot(what)))
    check_said_once(transport, "two sources speak on the")
    assert any(said == "learning resumed" for said in transport.said)
    script = [s for s in second_robot(what) if stamped(s) < END + 0.9]
    before, _ = run_node([s for s in drive() if stamped(s) < BEGIN + 0.5])
    after, _ = run_node(script)
    assert farthest(learned(after), learned(before)) <= 0.1
    closed = {key: n for key, n in transport.statuses[-1].counts.items() if "two sources" in key}
    assert sum(closed.values()) > 100


def test_an_operator_who_drives_past_the_commands_teaches_nothing() -> None:
    """Wheels say that the robot stands while an operator pushes it along."""
    script: list[Sample] = []
    for sample in drive():
        t = stamped(sample)
        if BEGIN <= t < END and isinstance(sample, Wheels):
            sample = replace(sample, v=0.0, omega=0.0)
        if t == BEGIN and isinstance(sample, Command):
            script.append(Override(t, True))
        if t == END and isinstance(sample, Command):
            script.append(Override(t, False))
        script.append(sample)
    assert sum(isinstance(each, Override) for each in script) == 2
    before, _ = run_node([s for s in drive() if stamped(s) < BEGIN])
    until = [s for s in script if isinstance(s, Override) or stamped(s) < END + RECOVERY]
    after, transport = run_node(until)
    assert farthest(learned(after), learned(before)) <= 0.1
    check_said_once(transport, "learning paused: an operator drives")
    whole, _ = run_node(script)
    assert whole.learning.segments > after.learning.segments + 10


def test_a_full_disk_is_said_once_and_the_state_is_saved_when_there_is_room(tmp_path: Path) -> None:
    place = tmp_path / "cache"
    place.write_text("in the way")  # whatever cannot be written fails alike
    transport = Scripted(list(drive()))
    settings = Settings(basis="edd-2").model_copy(update={"live": LiveTable(cache=str(place))})
    built = build_node(transport, "wheel", settings, run="test")
    for _ in range(3):
        built.node.save()
    place.unlink()
    built.node.run()
    check_said_once(transport, "the state cannot be saved")
    check_said_once(transport, "the state can be saved again")
    assert transport.statuses[-1].counts["a state that could not be saved"] == 3
    assert learned(built).content == reference().content
    assert list(place.glob("*.state"))


def test_idle_hours_raise_no_alarm_and_teach_nothing() -> None:
    last = drive()[-1]
    still = [s for s in drive() if isinstance(s, Pose)][-1]
    rng = np.random.default_rng(2)
    idle: list[Sample] = []
    for k in range(8 * 3600):
        t = stamped(last) + 1.0 + 1.0 * k
        x, y, yaw = rng.normal((still.x, still.y, still.yaw), (0.005, 0.005, 0.002)).tolist()
        idle += [Wheels(t, 0.0, 0.0), Wheels(t + 0.4, 0.0, 0.0), Pose(t + 0.5, x, y, yaw)]
    built, transport = run_node([*drive(), *idle])
    assert farthest(learned(built), reference()) <= 0.1
    assert not [said for said in transport.said if "terrain" in said or "stuck" in said]
