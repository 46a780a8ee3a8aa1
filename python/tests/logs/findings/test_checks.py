# SPDX-License-Identifier: Apache-2.0
"""Poses and inputs that contradict each other are found, and no robot that only slips or lags is."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import (
    SKID_STEERED,
    circular,
    dead_reckoned,
    scaled,
    since,
    sound_log,
    stopped,
    teleported,
    turned,
    with_poses,
    with_runs,
)
from faulty_logs import HALF_LATER, found_in, off_centre, sides, wheels, with_fault
from sample_logs import Drive, steady_run

from slipwise import _core
from slipwise.logs import Inputs, Log, LogOptions, Poses, open_log
from slipwise.logs.findings.checks import OF_STREAM, WHOLE, findings_in, findings_of, looked_at, seen_in
from slipwise.logs.findings.command_stops import CommandTimeout
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Floats
from slipwise.logs.open_log import cut_to_span

HALF = 30.0  # s
SOUND = sound_log()
CONTRADICTORY: dict[str, tuple[Log, str, str, str]] = {  # log, input, kind, what cures it
    "stopped": (stopped(SOUND, 0.0), "command", "does-not-move", "emergency stop"),
    "stopped, with noise": (stopped(SOUND, 0.0, 0.01), "wheel", "does-not-move", "localiser"),
    "stopped at half": (stopped(SOUND, HALF), "command", "does-not-move", "30."),
    "commands in rad/s": (
        scaled(SOUND, "commands", 1 / 0.15),
        "command",
        "unlikely-speed",
        "--command-scale 0.1",
    ),
    "wheels in rad/s": (scaled(SOUND, "wheels", 1 / 0.3), "wheel", "unlikely-speed", "--wheel-scale 0.2"),
    "commands flipped": (
        scaled(SOUND, "commands", -1.0),
        "command",
        "backward-poses",
        "--command-scale -1,1",
    ),
    "wheels flipped": (scaled(SOUND, "wheels", -1.0), "wheel", "backward-poses", "--wheel-scale -1,1 (times"),
    "turned by 180": (turned(SOUND, np.pi), "wheel", "backward-poses", "--pose-yaw-offset 3.1416"),
    "turned by 90": (turned(SOUND, 0.5 * np.pi), "wheel", "turned-poses", "--pose-yaw-offset -1.5708 (plus"),
    "turned by 40": (turned(SOUND, np.radians(40.0)), "wheel", "turned-poses", "--pose-yaw-offset -0."),
    "heading jumps": (turned(SOUND, np.pi, HALF), "command", "heading-jump", "two logs"),
    "no heading": (
        with_poses(SOUND, lambda p: replace(p, yaw=0.0 * p.yaw)),
        "wheel",
        "constant-heading",
        "yaw",
    ),
    "circular": (circular(SOUND), "command", "repeated-wheels", "lidar"),
}


def test_no_check_looks_twice() -> None:
    for checks in (WHOLE, OF_STREAM):
        assert len({type(check) for check in checks}) == len(checks)


def test_each_contradiction_is_named_with_what_cures_it(subtests: pytest.Subtests) -> None:
    for name, (log, input_name, kind, cure) in CONTRADICTORY.items():
        with subtests.test(name=name):
            found = [each for each in findings_of(log, input_name) if each.spoils]
            assert [each.kind for each in found] == [kind]
            assert cure in " ".join(found[0].advice)


def test_a_stopped_robot_is_said_in_these_words() -> None:
    found = findings_of(stopped(sound_log(), 0.0), "command")
    assert found[0].sentence.startswith("the robot does not move although it is commanded, for ")


def test_a_flipped_sign_is_told_from_a_turned_frame_by_the_other_input() -> None:
    flipped, both = scaled(sound_log(), "commands", -1.0), turned(sound_log(), np.pi)
    assert "--pose-yaw-offset" not in " ".join(findings_of(flipped, "command")[0].advice)
    assert findings_of(flipped, "wheel") == ()
    assert "--pose-yaw-offset" in findings_of(both, "command")[0].advice[0]


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_slip_lag_and_noise_are_no_contradiction(subtests: pytest.Subtests) -> None:
    for drive in [
        SKID_STEERED,
        replace(SKID_STEERED, lag=1.5, delay=0.4),  # sluggish
        replace(SKID_STEERED, alpha=(-0.5, -0.85)),  # on ice
        replace(SKID_STEERED, pose_std=(0.05, 0.03)),  # bad poses
        replace(SKID_STEERED, pose_std=(0.0, 0.0), slip_psd=(0.0, 0.0, 0.0)),  # a simulator's
        Drive(seconds=60.0, speeds=(0.0, 0.0)),  # turns on the spot
        Drive(seconds=60.0, speeds=(1.0, 1.0), yaw_rates=(0.0, 0.0)),  # straight on
        Drive(seconds=60.0, basis=_core.named_basis("edd-2"), alpha=(0.0, -0.02), pose_std=(0.001, 0.0005)),
    ]:
        for input_name in ["command", "wheel"]:
            with subtests.test(drive=drive, input_name=input_name):
                found = findings_of(sound_log(drive), input_name)  # what may be so of a sound robot says "or"
                assert not any(each.spoils or " or " not in each.sentence for each in found)


def test_a_short_stop_is_said_but_spoils_nothing() -> None:
    log = sound_log(replace(SKID_STEERED, seconds=120.0, speeds=(0.8, 1.5)))
    at = (log.runs[0].poses.t > 50.0) & (log.runs[0].poses.t < 60.0)
    hold = int(np.argmax(at))

    def held(p: Poses) -> Poses:
        x, y, yaw = (np.where(at, column[hold], column) for column in (p.x, p.y, p.yaw))
        return replace(p, x=x, y=y, yaw=yaw)

    found = findings_of(with_poses(log, held), "wheel")
    assert [(each.kind, each.spoils) for each in found] == [("does-not-move", False), ("frozen-poses", False)]
    assert "It stands still from 51.0 to 58.5 s." in found[0].advice


def test_a_sensor_that_is_turned_by_20_degrees_is_said_with_the_angle_and_spoils_nothing() -> None:
    log = turned(sound_log(), np.radians(20.0))
    for name in ("command", "wheel"):
        (found,) = findings_of(log, name)
        assert (found.kind, found.spoils) == ("turned-poses", False)
        assert found.evidence == pytest.approx(-20.0, abs=1.0)
        assert "to the right of their heading" in found.sentence
        assert "--pose-yaw-offset in force is wrong, --set sensor_extrinsics.yaw=0.3" in found.advice[0]
        assert findings_of(log, name, sensor=(0.0, 0.0, np.radians(20.0))) == ()


@pytest.mark.parametrize(("factor", "unit"), [(3.6, "in km/h (28 % of m/s)"), (2.237, "in miles per hour")])
def test_speeds_as_of_another_unit_are_said_and_spoil_nothing(factor: float, unit: str) -> None:
    log = scaled(sound_log(), "commands", factor)
    (found,) = findings_of(log, "command")
    assert (found.kind, found.spoils) == ("other-unit", False)
    assert unit in found.sentence
    assert found.evidence == pytest.approx(0.95 / factor, rel=0.02)
    assert findings_of(scaled(sound_log(), "commands", 3.0), "command") == ()


def test_a_drive_that_is_capped_is_none_of_another_unit() -> None:
    """Fast commands reach 27 % and slow ones all that is asked."""
    capped = sound_log(replace(SKID_STEERED, speeds=(-0.4, 0.4), lag=0.0))

    def asked_for_more(commands: Inputs) -> Inputs:
        return replace(commands, v=np.where(np.abs(commands.v) > 0.2, 3.6, 1.0) * commands.v)

    assert "other-unit" not in {f.kind for f in findings_of(commands_of(capped, asked_for_more), "command")}


def commands_of(log: Log, change: Callable[[Inputs], Inputs]) -> Log:
    """Change the commands of every run."""
    return with_runs(log, lambda r: r if r.commands is None else replace(r, commands=change(r.commands)))


def test_a_robot_whose_turns_are_not_in_its_inputs_is_no_robot_without_a_heading() -> None:
    log = sound_log(replace(SKID_STEERED, seconds=120.0))
    straight = commands_of(log, lambda c: replace(c, omega=0.0 * c.omega))
    (found,) = (each for each in findings_of(straight, "command") if each.spoils)
    assert found.kind == "missing-turns"
    assert "the commands drive straight on while the robot turns to the left by" in found.sentence
    assert findings_of(straight, "wheel") == ()
    veering = Drive(seconds=120.0, yaw_rates=(0.0, 0.0), basis=_core.Basis("v", ["V"], [], ["V"]))
    found_veering = findings_of(sound_log(replace(veering, alpha=(-0.05, 0.4))), "command")
    assert "missing-turns" not in {each.kind for each in found_veering}


def test_a_robot_that_turns_on_the_spot_steers_not() -> None:
    spot = sound_log(replace(SKID_STEERED, speeds=(0.0, 0.0)))
    (found,) = findings_of(commands_of(spot, lambda c: replace(c, wheelbase=0.5)), "command")
    assert (found.kind, found.spoils) == ("not-steered", True)
    assert "turns on the spot as it is commanded" in found.sentence
    assert "wheelbase" in found.advice[0]
    driven = sound_log(replace(SKID_STEERED, speeds=(0.3, 1.5)))
    assert findings_of(commands_of(driven, lambda c: replace(c, wheelbase=0.5)), "command") == ()


def test_an_arm_of_the_sensor_in_turns_to_one_side_is_not_said_to_turn_it() -> None:
    drive = replace(SKID_STEERED, basis=_core.named_basis("full-linear-6"), alpha=(0, 0, 0, 0.3, 0, 0))
    for yaw_rates in ((0.2, 0.8), (0.5, 0.5)):
        found = findings_of(sound_log(replace(drive, yaw_rates=yaw_rates)), "wheel")
        assert "turned-poses" not in {each.kind for each in found}


def test_a_sensor_that_is_known_to_be_turned_is_no_contradiction() -> None:
    log = turned(sound_log(), 0.5 * np.pi)
    assert findings_of(log, "wheel", sensor=(0.0, 0.0, 0.5 * np.pi)) == ()


def test_a_sensor_that_is_known_to_sit_off_the_centre_is_none() -> None:
    log = with_poses(sound_log(), lambda p: off_centre(p, 1.0, 0.2))
    (found,) = findings_of(log, "wheel")
    assert found.kind == "sensor-off-centre"
    assert findings_of(log, "wheel", sensor=(1.0, 0.2, 0.0)) == ()
    (nearer,) = findings_of(log, "wheel", sensor=(0.4, 0.2, 0.0))
    assert nearer.advice == found.advice


def test_a_log_without_the_input_or_without_motion_has_none() -> None:
    still = Log(runs=(steady_run(v=0.0),))
    assert findings_of(still, "command") == ()
    assert findings_of(replace(still, runs=(replace(still.runs[0], wheels=None),)), "wheel") == ()


LATE = 1000.0  # s
LONG = sound_log(replace(SKID_STEERED, seconds=1100.0))


LATELY: dict[str, tuple[Callable[[Log], Log], str, str]] = {  # what changes, input, kind
    "stuck": (lambda log: stopped(log, LATE, 0.01), "wheel", "does-not-move"),
    "rad/s": (lambda log: scaled(log, "wheels", 1 / 0.15), "wheel", "unlikely-speed"),
    "flipped": (lambda log: scaled(log, "wheels", -1.0), "wheel", "backward-poses"),
    "no yaw": (lambda log: with_poses(log, lambda p: replace(p, yaw=0.0 * p.yaw)), "wheel", "lost-heading"),
    "mirrored": (
        lambda log: with_poses(log, lambda p: replace(p, y=-p.y, yaw=-p.yaw)),
        "wheel",
        "implausible",
    ),
    "teleports": (lambda log: with_poses(log, teleported), "wheel", "unreachable-poses"),
}


@pytest.mark.parametrize("name", LATELY)
def test_what_begins_after_a_long_drive_is_found_in_the_last_two_minutes(name: str) -> None:
    change, input_name, kind = LATELY[name]
    found = findings_of(since(LONG, change, LATE), input_name)
    assert found[0].kind == kind
    assert found[0].spoils
    assert found[0].sentence.startswith("in the last two minutes of driving, ")
    assert any("--end" in text for text in found[0].advice)


def test_a_long_sound_drive_has_no_contradiction() -> None:
    assert findings_of(LONG, "wheel") == ()
    assert findings_of(LONG, "command") == ()


@pytest.mark.parametrize(
    ("poses", "kind"),
    [
        (circular(SOUND), "repeated-wheels"),
        (with_poses(SOUND, lambda p: replace(p, yaw=-p.yaw)), "implausible"),
        (turned(SOUND, 0.5 * np.pi), None),
        (SOUND, None),
    ],
    ids=["repeats the wheels", "clockwise", "turned on the robot", "sound"],
)
def test_poses_of_a_further_source_are_held_against_the_inputs_too(poses: Log, kind: str | None) -> None:
    (first,), (other,) = SOUND.runs, poses.runs
    both = replace(SOUND, runs=(replace(first, source="lidar", others={"odom": other.poses}),))
    found = findings_of(both, "wheel")
    assert [each.kind for each in found] == ([] if kind is None else [kind])
    for each in found:
        assert each.spoils
        assert each.sentence.startswith("of the source odom: ")
        assert each.advice[-1] == "Or leave out odom."


def test_two_sources_that_turn_by_different_angles_spoil_the_model() -> None:
    sound = sound_log(replace(SKID_STEERED, seconds=150.0))
    (run,) = sound.runs
    more = replace(run.poses, yaw=1.3 * np.unwrap(run.poses.yaw))
    both = replace(sound, runs=(replace(run, source="lidar", others={"odom": more}),))
    found = [each for each in findings_of(both, "wheel") if each.kind == "source-turns"]
    assert len(found) == 1
    assert found[0].spoils
    assert found[0].evidence == pytest.approx(1.3, abs=0.02)
    assert "odom turns 1.30" in found[0].sentence


def test_poses_that_begin_to_repeat_the_wheels_are_found_in_the_last_two_minutes() -> None:
    (run,) = LONG.runs
    assert run.wheels is not None
    repeated = replace(run, poses=joined_poses(run.poses, dead_reckoned(run.wheels), LATE))
    (found,) = findings_of(replace(LONG, runs=(repeated,)), "wheel")
    assert (found.kind, found.spoils) == ("repeated-wheels", True)


def joined_poses(first: Poses, then: Poses, t: float) -> Poses:
    """One source of poses until a time [s], another from then on, in a frame of its own."""
    early, late = first.t < t, then.t >= t
    columns = {
        name: np.concatenate((getattr(first, name)[early], getattr(then, name)[late]))
        for name in ("t", "x", "y", "yaw")
    }
    frame = np.concatenate((first.frame[early], then.frame[late] + 1))
    return Poses(**columns, frame=frame)


@pytest.mark.slow
def test_no_real_robot_contradicts_its_inputs(real_log_dir: Path) -> None:
    """Neither in the whole log nor in what had come until some time in it."""
    found = []
    for path in sorted(real_log_dir.glob("*/*.csv.gz")):
        log = open_log(path, options=LogOptions(wheelbase=0.32 if path.parent.name == "f1tenth" else None))
        last = max(run.span[1] for run in log.runs) - min(run.span[0] for run in log.runs)
        for end in (*np.arange(40.0, last, 20.0), last + 1.0):
            part, seen = cut_to_span(log, None, float(end)), None
            for name in ("command", "wheel"):
                ended = looked_at(WholeLog(part, name), (CommandTimeout(),))
                seen = seen_in(part, name, UNKNOWN_AFTER, before=seen)  # the evidence is of both inputs
                every = (*findings_in(seen), *ended)
                found += [(path.name, end, name, each.sentence) for each in every if each.spoils]
    assert found == []


def test_a_wheel_that_dies_on_the_way_is_found() -> None:
    """What it says of the whole drive is no twist of one wheel, and its last two minutes are not either."""

    def dies(left: Floats, right: Floats, t: Floats) -> tuple[Floats, Floats]:
        return np.where(t > t[0] + 70.0, 0.0, left), right

    sound = sound_log(replace(SKID_STEERED, seconds=150.0))
    found = [each for each in found_in(with_fault(sound, wheels(sides(dies)))) if each.kind == "dead-wheel"]
    assert len(found) == 1
    assert re.search(r"from (6[5-9]|7\d|8\d) s on.* left wheel stands still", found[0].sentence)


@pytest.mark.parametrize("name", ["wheel", "command"])
def test_poses_in_feet_spoil_both_inputs_that_agree(name: str) -> None:
    feet = with_fault(
        SOUND, lambda run: replace(run, poses=replace(run.poses, x=3.28 * run.poses.x, y=3.28 * run.poses.y))
    )
    assert "unlikely-speed" in {each.kind for each in findings_of(feet, name) if each.spoils}


def test_a_wheel_that_counts_half_is_said_and_spoils_where_it_began_on_the_way() -> None:
    """A model of its wheels holds as long as they count so: it is none of half of a drive."""
    sound = sound_log(replace(SKID_STEERED, seconds=150.0))
    always = with_fault(sound, wheels(sides(lambda left, right, t: (left, 0.5 * right))))
    whole, later = (
        next(each for each in findings_of(log, "wheel") if each.kind == "uneven-wheels")
        for log in (always, with_fault(sound, wheels(HALF_LATER)))
    )
    assert not whole.spoils
    assert whole.evidence == pytest.approx(2.0 * 0.6, abs=0.05)  # 1 m/s of left wheels that are .5 m apart
    assert later.spoils
    assert re.search(r"by -?0.00 rad for each metre until (7[2-9]|80) s, and by -1.2", later.sentence)
