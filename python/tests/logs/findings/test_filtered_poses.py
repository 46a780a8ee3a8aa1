# SPDX-License-Identifier: Apache-2.0
"""Poses of a filter that takes in the wheels are found with what arrives in the long run; others are not."""

from __future__ import annotations

from dataclasses import replace

import pytest
from contradictory_logs import SKID_STEERED, filtered, sound_log, with_poses, with_runs

from slipwise.calibration import calibrate
from slipwise.logs import Log, Run
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.findings.filtered_poses import FilteredPoses
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import WholeLog

GOES, TURNS = 0.85, 0.8  # of what the wheels say, by the robot
DRIVE = replace(SKID_STEERED, seconds=150.0, alpha=(GOES - 1.0, TURNS - 1.0))


def filtered_log(after: float, *, heading: bool = True, every: float = 0.0) -> Log:
    def change(run: Run) -> Run:
        return filtered(run, after, heading=heading, every=every)

    return with_runs(sound_log(DRIVE), change)


def found_in(log: Log, name: str = "wheel") -> Finding | None:
    return FilteredPoses().look_at(WholeLog(log, name))


@pytest.mark.parametrize("after", [1.5, 4.0, 10.0])
@pytest.mark.parametrize("wheels", [True, False])
def test_what_arrives_in_the_long_run_is_found(after: float, wheels: bool) -> None:
    log = filtered_log(after)
    if not wheels:
        log = replace(log, runs=tuple(replace(run, wheels=None) for run in log.runs))
    found = found_in(log, "wheel" if wheels else "command")
    assert found is not None
    assert found.spoils
    assert found.evidence == pytest.approx(after, rel=0.5)
    assert float(found.sentence.split("long run ")[1].split(" %")[0]) == pytest.approx(100.0 * TURNS, abs=3.0)


def test_a_gyro_hides_no_filter_of_the_way() -> None:
    found = found_in(filtered_log(5.0, heading=False))
    assert found is not None
    assert "they go" in found.sentence
    assert float(found.sentence.split("long run ")[1].split(" %")[0]) == pytest.approx(100.0 * GOES, abs=3.0)


def test_positions_of_a_filter_are_found_too() -> None:
    found = found_in(with_poses(filtered_log(5.0, heading=False), lambda p: replace(p, course=True)))
    assert found is not None
    assert "they go" in found.sentence
    assert found_in(with_poses(sound_log(DRIVE), lambda p: replace(p, course=True))) is None


def test_no_model_of_such_poses_is_good() -> None:
    verdict = calibrate(filtered_log(3.0), input="wheel").verdict
    assert not verdict.good
    assert "the poses follow the wheels at first and are corrected later" in str(verdict)


def test_a_filter_as_further_source_is_named() -> None:
    (run,) = sound_log(DRIVE).runs
    (other,) = filtered_log(3.0).runs
    beside = Log(runs=(replace(run, source="rtk", others={"ekf": other.poses}),))
    assert [each.sentence[:30] for each in findings_of(beside, "wheel")] == ["of the source ekf: the poses f"]


def test_a_filter_that_is_corrected_whole_is_none() -> None:
    assert found_in(filtered_log(1.0, every=0.5)) is None


def test_robots_that_slip_or_turn_late_are_none() -> None:
    for drive in (DRIVE, replace(DRIVE, lag=0.8, delay=0.4), SKID_STEERED):
        for seed in (1, 2):
            log = sound_log(replace(drive, seconds=150.0, seed=seed))
            assert found_in(log) is None
            without = Log(runs=tuple(replace(run, wheels=None) for run in log.runs))
            assert found_in(without, "command") is None
    drifting = replace(SKID_STEERED, seconds=300.0, disturbance=(0.2, 5.0))
    assert found_in(sound_log(drifting)) is None
