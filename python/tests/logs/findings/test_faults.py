# SPDX-License-Identifier: Apache-2.0
"""Each fault of wiring is found in each log that it is put into, and none in logs of sound robots."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log
from faulty_logs import drifting, found_in, not_found

from slipwise.logs import Inputs, Log, LogOptions, Poses, open_log
from slipwise.logs.findings.checks import EVERY
from slipwise.logs.findings.diagnose import diagnose_log
from slipwise.logs.findings.drifting_poses import DriftingPoses
from slipwise.logs.findings.finding import FAMILIES
from slipwise.logs.findings.seen import WholeLog

REAL = (
    "husky/tile_deflated_tyres",
    "warthog/grass_7_29_14h46s15",
    "warthog/grass_8_8_15h56s39",
    "warthog/asphalt_9_25_12h8s57",
    "f1tenth/DS3",
    "create/MRCLAM6_R1",
)
#: Five logs for each, with those of REAL.
FURTHER = {
    "capped drive": (
        "data/warthog/grass_7_18_16h59s20",
        "vehicles/fomo_warthog_red_2025-10-14",
        "foreign/bullet/husky",
    ),
    "ticks jump": ("data/warthog/grass_7_18_16h59s20", "data/f1tenth/DS4"),
    "multipath": ("data/warthog/grass_7_18_16h59s20", "data/warthog/grass"),
}
#: What is true of these logs, and therefore found.
TRUE = {
    "LVMS_23_01_04_B": {"echoed-commands"},  # its commands are the speed of the rear wheels
    "dart_rubbery_floor": {"does-not-move"},  # its throttle acts only where a safety switch is on
    "dart_steering_steps_rubbery": {"does-not-move"},  # the same
    "wetgrass_bad_poses": {"saturated"},  # its drive turns at 1 rad/s at most, and 1.6 are commanded
    "husky_weak_motors": {"does-not-move"},  # at its end the wheels turn at 0.5 m/s and the poses stand
}


def real_log(path: Path) -> Log:
    options: dict[str, Any] = {"f1tenth": {"wheelbase": 0.32}}.get(path.parent.name, {})
    if path.name.startswith("dart"):
        options = {"vehicle": "dart"}
    return open_log(path, options=LogOptions.of(options))


def test_each_fault_is_found_in_a_simulated_drive() -> None:
    log = sound_log(replace(SKID_STEERED, seconds=150.0))
    assert found_in(log) == ()
    assert not_found(log, "simulated") == []


def test_positions_that_drift_are_found_while_the_robot_stands() -> None:
    sound = sound_log(replace(SKID_STEERED, seconds=60.0))
    (run,) = sound.runs
    assert run.wheels is not None
    t, rest = np.arange(0.0, 30.0, 0.1), np.zeros(300)
    stood = replace(
        run,
        commands=None,
        wheels=Inputs(t=t, v=rest, vy=rest, omega=rest),
        poses=Poses(t=t, x=0.01 * np.cos(7.0 * t), y=rest, yaw=rest, frame=np.zeros(300, np.int64)),
    )
    drifted = replace(stood, poses=drifting(stood.poses))
    found = DriftingPoses().look_at(WholeLog(replace(sound, runs=(drifted,)), "wheel"))
    assert found is not None
    assert found.sentence.startswith("positions drift by ")
    assert found.evidence == pytest.approx(
        float(np.hypot(np.ptp(drifted.poses.x), np.ptp(drifted.poses.y))), rel=0.2
    )
    assert DriftingPoses().look_at(WholeLog(replace(sound, runs=(stood,)), "wheel")) is None


@pytest.mark.slow
def test_each_fault_is_found_in_real_logs(real_log_dir: Path) -> None:
    missed = []
    for name in REAL:
        missed += not_found(real_log(real_log_dir / f"{name}.csv.gz"), name.split("/")[1])
    assert missed == []


@pytest.mark.slow
def test_what_not_every_drive_shows_is_found_in_further_logs(real_log_dir: Path) -> None:
    missed = []
    for fault, names in FURTHER.items():
        for name in names:
            log = real_log(real_log_dir.parent / f"{name}.csv.gz")
            missed += not_found(log, name.split("/")[-1], [fault])
    assert missed == []


@pytest.mark.slow
def test_nothing_false_is_found_in_a_real_log(real_log_dir: Path) -> None:
    beside = real_log_dir.parent
    paths = [
        *real_log_dir.glob("*/*.csv.gz"),
        *beside.glob("vehicles/*.csv.gz"),
        *beside.glob("foreign/*/*.csv.gz"),
    ]
    without = ("comma2k19",)  # no yaw rate beside its speed
    found = {}
    for path in sorted(each for each in paths if not each.name.startswith(without)):
        kinds = {each.kind for each in diagnose_log(real_log(path))}
        if kinds:
            found[path.name.removesuffix(".csv.gz")] = kinds
    assert found == {name: kinds for name, kinds in TRUE.items() if any(name in p.name for p in paths)}


def test_each_check_says_what_it_is() -> None:
    for check in EVERY:
        assert check.family in FAMILIES
        assert all(text and "|" not in text for text in (check.means, check.shows, check.cure))
