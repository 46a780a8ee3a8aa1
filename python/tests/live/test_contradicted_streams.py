# SPDX-License-Identifier: Apache-2.0
"""A live stream that contradicts itself hands nothing on, or takes back what it handed on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import (
    SKID_STEERED,
    circular,
    scaled,
    since,
    sound_log,
    stopped,
    teleported,
    turned,
    with_poses,
    with_runs,
)
from scripted_node import Scripted, run_node

from slipwise.calibration.live_table import ApplyTable, LiveTable
from slipwise.calibration.prepared_run import prepare_run
from slipwise.export import export_model
from slipwise.live import applied
from slipwise.live.build import Built
from slipwise.live.outputs import AppliedParameters, ModelText
from slipwise.live.replay import samples_of
from slipwise.logs import Inputs, Log, Poses, Run
from slipwise.models import parse_model

DRIVE = replace(SKID_STEERED, seconds=80.0, pose_std=(0.01, 0.005))
HALF = 45.0  # s
MARK = "# Withdrawn at stamp "


def with_inputs(log: Log, change: Callable[[Inputs], Inputs]) -> Log:
    def changed(run: Run) -> Run:
        assert run.commands is not None
        assert run.wheels is not None
        return replace(run, commands=change(run.commands), wheels=change(run.wheels))

    return with_runs(log, changed)


def random_yaw(p: Poses) -> Poses:
    return replace(p, yaw=np.random.default_rng(5).uniform(-3.0, 3.0, len(p)))


STREAMS: dict[str, Callable[[Log], Log]] = {
    "frozen localiser": lambda log: stopped(log, 0.0),
    "frozen localiser with noise": lambda log: stopped(log, 0.0, 0.01),
    "stuck from the middle on": lambda log: stopped(log, HALF),
    "omega in deg/s": lambda log: with_inputs(log, lambda i: replace(i, omega=np.degrees(i.omega))),
    "v flipped": lambda log: with_inputs(log, lambda i: replace(i, v=-i.v)),
    "omega flipped": lambda log: with_inputs(log, lambda i: replace(i, omega=-i.omega)),
    "v and omega swapped": lambda log: with_inputs(log, lambda i: replace(i, v=i.omega, omega=i.v)),
    "speeds in rad/s": lambda log: scaled(scaled(log, "commands", 1 / 0.15), "wheels", 1 / 0.15),
    "poses in feet": lambda log: with_poses(log, lambda p: replace(p, x=p.x / 0.3048, y=p.y / 0.3048)),
    "poses turned by 90": lambda log: turned(log, 0.5 * np.pi),
    "poses turned by -90": lambda log: turned(log, -0.5 * np.pi),
    "poses turned by 180": lambda log: turned(log, np.pi),
    "heading jumps by 180": lambda log: turned(log, np.pi, HALF),
    "x and y swapped": lambda log: with_poses(log, lambda p: replace(p, x=p.y, y=p.x)),
    "y mirrored": lambda log: with_poses(log, lambda p: replace(p, y=-p.y)),
    "yaw mirrored": lambda log: with_poses(log, lambda p: replace(p, yaw=-p.yaw)),
    "yaw as a compass has it": lambda log: with_poses(log, lambda p: replace(p, yaw=0.5 * np.pi - p.yaw)),
    "yaw in degrees": lambda log: with_poses(log, lambda p: replace(p, yaw=np.degrees(p.yaw))),
    "yaw always 0": lambda log: with_poses(log, lambda p: replace(p, yaw=0.0 * p.yaw)),
    "yaw that drifts": lambda log: with_poses(log, lambda p: replace(p, yaw=p.yaw + 0.06 * p.t)),
    "random yaw": lambda log: with_poses(log, random_yaw),
    "teleports": lambda log: with_poses(log, teleported),
    "poses that repeat the wheels": circular,
}
QUICK = ("omega in deg/s", "heading jumps by 180")


@cache
def sound(seconds: float = DRIVE.seconds) -> Log:
    return sound_log(replace(DRIVE, seconds=seconds))


def lived(
    log: Log, folder: Path, input_name: str = "wheel", basis: str = "edd-2", **table: object
) -> tuple[Built, Scripted]:
    """Run a node that hands on whatever it may; contradictions do not depend on the basis."""
    (run,) = prepare_run(log, input_name)
    apply = ApplyTable(
        mode="auto",
        folder=str(folder),
        targets=["diff-drive", "amcl"],
        set_parameters=True,
        interval=1.0,
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(applied, "RATE", 1.0)  # at once
        patch.setenv("ROS_DISTRO", "jazzy")
        return run_node(list(samples_of(run)), LiveTable(apply=apply, **table), input_name, basis)  # type: ignore[arg-type]


def faults_of(built: Built, transport: Scripted, folder: Path) -> list[str]:
    """What is wrong with a node at the end of a stream that contradicts itself."""
    found = []
    model = built.learning.model
    if model is not None and model.content.verdict.good:
        found.append("its verdict is good")
    if built.learning.validity.whole == "estimated":
        found.append("it is valid")
    found += _faults_of_handing_on(transport.said)
    files = {file.name: file.read_text() for file in folder.iterdir()}
    return [*found, *(f"{name} is not marked" for name, text in files.items() if not text.startswith(MARK))]


def _faults_of_handing_on(said: list[str]) -> list[str]:
    """What is wrong with the order in which things were handed on and taken back."""
    found = []
    handed, standing = False, False
    for text in said:
        if text.startswith("written to "):
            handed = True
            found += ["it was handed on against a contradiction"] if standing else []
        elif "are withdrawn" in text:
            handed = False
        elif text.startswith("the learned model is not used"):
            standing = True
        elif text.startswith("poses and inputs agree again"):
            standing = False
    return [*found, *(["it was handed on and not withdrawn"] if handed else [])]


@pytest.mark.parametrize("name", QUICK)
def test_nothing_is_handed_on_of_a_stream_that_contradicts_itself(name: str, tmp_path: Path) -> None:
    built, transport = lived(STREAMS[name](sound()), tmp_path)
    assert faults_of(built, transport, tmp_path) == []


@pytest.mark.slow
@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_no_stream_that_contradicts_itself_is_handed_on(input_name: str, tmp_path: Path) -> None:
    faults = {}
    for number, (name, change) in enumerate(STREAMS.items()):
        folder = tmp_path / str(number)
        folder.mkdir()
        found = faults_of(*lived(change(sound()), folder, input_name), folder)
        if found:
            faults[name] = found
    assert faults == {}


def test_a_sound_stream_is_handed_on_once_contradictions_would_have_shown_themselves(tmp_path: Path) -> None:
    built, transport = lived(sound(), tmp_path)
    assert built.learning.valid_now is not None
    assert any(text.startswith("written to ") for text in transport.said)
    first = next(t for t, text in built.said.log() if text.startswith("model valid: "))
    assert first > 22.0  # fifteen stretches of 1.5 s
    assert parse_model((tmp_path / "model.yaml").read_text(), where="").content.verdict.good


def test_what_was_handed_on_is_withdrawn_with_the_start_values_and_a_word_why(tmp_path: Path) -> None:
    sound_half = stopped(sound(), HALF)
    built, transport = lived(sound_half, tmp_path)
    assert any(text.startswith("written to ") for text in transport.said)
    (said,) = [text for text in transport.said if "are withdrawn" in text]
    assert "the robot does not move although its wheels turn" in said
    text = (tmp_path / "model.yaml").read_text()
    assert text.startswith(MARK)
    withdrawn = parse_model(text, where="")
    assert not withdrawn.content.verdict.good
    assert len(withdrawn.content.parameters) == 0
    other = (tmp_path / "nav2_amcl.yaml").read_text()
    assert other.startswith(MARK)
    last = [o.text for o in transport.outputs if isinstance(o, ModelText)][-1]
    assert not parse_model(last, where="").content.verdict.good
    assert built.learning.valid is None


LONG, LATE = 420.0, 260.0  # s
LATER: dict[str, Callable[[Log], Log]] = {
    "frozen localiser": lambda log: stopped(log, LATE),
    "v flipped": STREAMS["v flipped"],
    "omega flipped": STREAMS["omega flipped"],
    "poses turned by 90": STREAMS["poses turned by 90"],
    "y mirrored": STREAMS["y mirrored"],
    "teleports": STREAMS["teleports"],
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LATER)
def test_what_a_long_good_drive_handed_on_is_withdrawn_within_two_minutes_and_stays_so(
    name: str, tmp_path: Path
) -> None:
    built, transport = lived(since(sound(LONG), LATER[name], LATE), tmp_path)
    assert faults_of(built, transport, tmp_path) == []
    withdrawn = [t for t, text in built.said.log() if "are withdrawn" in text]
    assert len(withdrawn) == 1
    assert LATE < withdrawn[0] < LATE + 120.0
    assert not any(text.startswith("written to ") for t, text in built.said.log() if t > withdrawn[0])


def test_a_start_model_is_what_is_there_again_after_a_contradiction(tmp_path: Path) -> None:
    start = tmp_path / "start.yaml"
    built, _ = lived(sound(), tmp_path, basis="auto")
    learned = built.learning.valid
    assert learned is not None
    learned.save(start)
    (tmp_path / "apply").mkdir()
    built, transport = lived(stopped(sound(), HALF), tmp_path / "apply", basis="auto", model=str(start))
    assert any("are withdrawn" in text for text in transport.said)
    again = parse_model((tmp_path / "apply" / "model.yaml").read_text(), where="")
    assert again.content.parameters == learned.content.parameters
    told = {name for o in transport.outputs if isinstance(o, AppliedParameters) for name in o.values}
    left = " ".join(text for text in transport.said if text.startswith("the start has no "))
    assert all(name in left for name in told - export_model(learned, "amcl", name="the start").values.keys())
    assert built.learning.given()[0] == built.learning.start
