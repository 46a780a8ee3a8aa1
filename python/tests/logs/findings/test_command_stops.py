# SPDX-License-Identifier: Apache-2.0
"""A watchdog is found by silences long ago, and from pieces of a stream as from the whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise.logs import Inputs, Poses, open_log
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.findings.command_stops import CommandStops
from slipwise.logs.findings.commanded_motion import CommandedMotion
from slipwise.logs.log import Floats

DELAY, WAITS = 0.1, 0.4  # s


def drive(seconds: float, silent_until: float) -> tuple[Inputs, Poses]:
    """Commands at 10 Hz; until some time none in the last two of ten seconds, in which the robot stops."""
    t = np.round(np.arange(0.0, seconds, 0.1), 9)
    sent = (t % 10.0 < 8.0) | (t >= silent_until)
    age: Floats = t - DELAY - t[sent][np.maximum(np.searchsorted(t[sent], t - DELAY, side="right") - 1, 0)]
    x = np.concatenate(([0.0], np.cumsum(0.1 * np.where(age[:-1] < WAITS - 1e-6, 0.5, 0.0))))
    rest = np.zeros_like(t)
    commands = Inputs(t=t[sent], v=0.5 + rest[sent], vy=rest[sent], omega=rest[sent])
    return commands, Poses(t=t, x=x, y=rest, yaw=rest, frame=np.zeros(len(t), np.int64))


def pieces(commands: Inputs, poses: Poses, seconds: float) -> list[tuple[Inputs, Poses]]:
    """Both as a live node has them: the last command and the last pose of a piece begin the next."""
    found = []
    for begin in np.arange(0.0, poses.t[-1], seconds):
        p = (poses.t >= begin) & (poses.t <= begin + seconds)
        c = slice(
            max(int(np.searchsorted(commands.t, begin, side="right")) - 1, 0),
            int(np.searchsorted(commands.t, begin + seconds, side="right")),
        )
        found.append((commands.select(c), poses.select(p)))
    return found


@pytest.mark.parametrize(("seconds", "silent_until"), [(120.0, 120.0), (2400.0, 300.0)])
def test_silences_are_found_in_a_whole_log_and_in_its_pieces(seconds: float, silent_until: float) -> None:
    whole, live = CommandStops(), CommandStops()
    commands, poses = drive(seconds, silent_until)
    whole.add(commands, poses)
    for each in pieces(commands, poses, 30.0):
        live.add(*each)
    assert whole.after() == pytest.approx(WAITS, abs=0.051)
    assert live.after() == whole.after()
    assert whole.words(0.5) == live.words(0.5)


def test_parts_have_all_steps_and_the_command_in_force() -> None:
    motion = CommandedMotion.between(*drive(100.0, 100.0))
    assert motion is not None
    parts = motion.parts(30.0)
    np.testing.assert_array_equal(np.concatenate([each.start for each in parts]), motion.start)
    assert all(each.t[0] <= each.start[0] for each in parts)
    assert parts[-1].t[-1] == motion.t[-1]
    assert max(each.seconds for each in parts) < 30.2


def test_zeros_of_a_watchdog_that_was_given_are_no_second_source(tmp_path: Path) -> None:
    """A robot that is commanded every second stops after half of it: `--command-timeout` was advised."""
    t = np.arange(0.0, 120.0, 0.05)
    speed = np.where(t // 10.0 % 2.0 == 0.0, 0.8, 0.5)
    x = np.cumsum(0.05 * np.where(t % 1.0 < 0.5, speed, 0.0))
    given = np.isclose(t % 1.0, 0.0, atol=1e-6) | np.isclose(t % 1.0, 1.0, atol=1e-6)
    rows = [
        f"{at:.2f},{f'{v},0' if said else ','},{place:.4f},0,0"
        for at, v, said, place in zip(t.tolist(), speed.tolist(), given.tolist(), x.tolist(), strict=True)
    ]
    path = tmp_path / "rare.csv"
    path.write_text("t,cmd_v,cmd_omega,x,y,yaw\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (found,) = findings_of(open_log(path), "command")
    assert found.kind == "command-timeout"
    assert found.evidence == pytest.approx(0.5, abs=0.051)
    assert findings_of(open_log(path, command_timeout=0.5), "command") == ()
