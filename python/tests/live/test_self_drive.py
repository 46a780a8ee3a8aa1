# SPDX-License-Identifier: Apache-2.0
"""A drive waits, counts down, commands its moves, and ends with commands to stand whatever happens."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace

import pytest

from slipwise.errors import SettingsError
from slipwise.excitation import Move
from slipwise.live.drive_guard import DriveBounds, DriveGuard
from slipwise.live.drive_link import DriveLog
from slipwise.live.samples import Pose
from slipwise.live.self_drive import INTERRUPTED, DrivePlan, DriveReport, SelfDrive

MOVES = (Move(0.5, 0.2, 0.1, 0.05), Move(-0.5, -0.2, 0.1, 0.05))
PLAN = DrivePlan(MOVES, lead=0.05, rate=100.0, countdown=0.05, stand=0.03, late=5.0)

#: A computer that runs tests may be busy: what is heard holds for long.
BOUNDS = DriveBounds(-1.0, 1.0, -1.0, 1.0, 1.0, 1.0, dead_man_within=5.0, pose_within=5.0)


class Link:
    """A robot that stands where it is, and a person who presses the button until `act` does something."""

    def __init__(self, act: Callable[[Link], None] = lambda _: None) -> None:
        self.log, self.sent = DriveLog(), list[tuple[float, float]]()
        self.act, self.guard = act, None
        self.pressed = True
        self.driver: SelfDrive | None = None
        self.problem: Exception | None = None
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._live, daemon=True)

    def hear(self, guard: DriveGuard) -> None:
        self.guard = guard
        self._thread.start()

    def missing(self) -> str:
        return ""

    def send(self, v: float, omega: float) -> None:
        if self.problem is not None and (v or omega):
            raise self.problem
        self.sent.append((v, omega))
        if v != 0.0:
            self.act(self)

    def close(self) -> None:
        self._ended.set()

    def _live(self) -> None:
        t = 0.0
        while not self._ended.wait(0.02):
            t += 0.02
            assert self.guard is not None
            self.guard.take_dead_man(self.pressed)
            self.guard.take_pose(Pose(t, 0.0, 0.0, 0.0))


def driven(
    act: Callable[[Link], None] = lambda _: None, plan: DrivePlan = PLAN, said: list[str] | None = None
) -> tuple[DriveReport, Link]:
    link = Link(act)
    guard = DriveGuard(BOUNDS)
    link.driver = SelfDrive(link, guard, plan, say=(said if said is not None else []).append)
    try:
        return link.driver.run(), link
    finally:
        link.close()


def test_all_moves_are_commanded_in_their_order_and_the_robot_stands_at_the_end() -> None:
    said: list[str] = []
    report, link = driven(said=said)
    assert report.why == ""
    assert report.moves == 2
    assert list(dict.fromkeys(link.sent)) == [(0.0, 0.0), (0.5, 0.2), (-0.5, -0.2)]
    assert link.sent.count((0.5, 0.2)) == pytest.approx(10, abs=5)
    assert link.sent[0] == link.sent[-1] == (0.0, 0.0)
    assert "the robot drives in 1 s" in said
    assert report.room_left == pytest.approx(1.0)


def test_a_released_button_is_followed_by_commands_to_stand_alone() -> None:
    def release(link: Link) -> None:
        link.pressed = False
        assert link.guard is not None
        link.guard.take_dead_man(False)

    report, link = driven(release)
    assert report.why == "the dead man's button was released"
    assert report.moves == 1
    assert [command for command in link.sent if command != (0.0, 0.0)] == [(0.5, 0.2)]
    assert 0.0 <= report.stopped_after < 1.0


def test_stop_ends_the_drive_with_commands_to_stand() -> None:
    def stop(link: Link) -> None:
        assert link.driver is not None
        link.driver.stop()

    report, link = driven(stop)
    assert report.why == INTERRUPTED
    assert link.sent[-1] == (0.0, 0.0)
    assert link.sent.count((0.5, 0.2)) == 1


@pytest.mark.parametrize("problem", [RuntimeError("broken"), KeyboardInterrupt()])
def test_on_any_exception_the_robot_is_commanded_to_stand(problem: BaseException) -> None:
    link = Link()

    def fail(_: Link) -> None:
        raise problem

    link.act = fail
    guard = DriveGuard(BOUNDS)
    with pytest.raises(type(problem)):
        SelfDrive(link, guard, PLAN, say=lambda _: None).run()
    link.close()
    assert link.sent[-1] == (0.0, 0.0)
    assert link.sent.count((0.5, 0.2)) == 1


def test_a_command_beyond_the_limits_is_never_sent() -> None:
    fast = DrivePlan((Move(1.5, 0.0, 0.2, 0.0),), lead=0.0, countdown=0.0, stand=0.0)
    with pytest.raises(ValueError, match="beyond the limits"):
        driven(plan=fast)


@pytest.mark.slow
def test_a_computer_that_is_busy_ends_the_drive() -> None:
    report, link = driven(lambda _: time.sleep(0.4), plan=replace(PLAN, late=0.25))
    assert "busy" in report.why
    assert link.sent[-1] == (0.0, 0.0)


def test_before_the_button_is_pressed_nothing_is_commanded() -> None:
    link, said = Link(), list[str]()
    link.pressed = False
    guard = DriveGuard(BOUNDS)
    driver = SelfDrive(link, guard, PLAN, say=said.append)
    threading.Timer(0.15, driver.stop).start()
    report = driver.run()
    link.close()
    assert (report.why, report.commands, link.sent) == (INTERRUPTED, 0, [])
    assert any("dead man" in text for text in said)


def test_topics_that_do_not_fit_end_it_without_a_command() -> None:
    link = Link()

    def wrong() -> str:
        raise SettingsError("another type")

    link.missing = wrong  # type: ignore[method-assign]
    with pytest.raises(SettingsError, match="another type"):
        SelfDrive(link, DriveGuard(DriveBounds(-1, 1, -1, 1, 1, 1)), PLAN, say=lambda _: None).run()
    assert link.sent == []
    link.close()


def test_the_plan_stands_before_between_and_after_moves() -> None:
    times = (0.02, 0.1, 0.17, 0.25, 0.32, 9.0)
    assert [PLAN.command(t) for t in times] == [
        (0.0, 0.0, 0),
        (0.5, 0.2, 1),
        (0.0, 0.0, 1),
        (-0.5, -0.2, 2),
        (0.0, 0.0, 2),
        (0.0, 0.0, 0),
    ]
    assert PLAN.seconds == pytest.approx(0.35)
