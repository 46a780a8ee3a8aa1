# SPDX-License-Identifier: Apache-2.0
"""A clock that steps or drifts is found with its number; one that does not, or that nothing shows, is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log, with_poses
from faulty_logs import at_rate, stepping
from sample_logs import Drive

from slipwise.calibration import calibrate
from slipwise.logs import Log, open_log
from slipwise.logs.findings.clock_drift import ClockDrift
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.open_log import cut_to_span

LOG = sound_log(replace(SKID_STEERED, seconds=200.0))
REAL = ("husky/tile_deflated_tyres", "warthog/grass_7_29_14h46s15", "f1tenth/DS4", "create/MRCLAM6_R1")


def found_in(log: Log) -> Finding | None:
    return ClockDrift().look_at(WholeLog(log, "wheel"))


def of_commands(log: Log) -> Log:
    return replace(log, runs=tuple(replace(run, wheels=None) for run in log.runs))


@pytest.mark.parametrize("seconds", [0.15, 0.25, 0.5])
def test_a_step_is_said_with_its_size_and_its_time(seconds: float) -> None:
    log = with_poses(LOG, stepping(seconds))
    for each in (log, of_commands(log)):
        found = found_in(each)
        assert found is not None
        assert found.spoils
        assert found.sentence.startswith(f"the poses' clock steps forward by {seconds:.1f}"[:-1])
        assert found.evidence == pytest.approx(seconds, abs=0.05)
        said = float(found.sentence.split("(t = ")[1].split(" s)")[0])
        assert said == pytest.approx(100.0, abs=10.0)
        assert ("or the drive answers later since" in found.sentence) == (each is not log)


@pytest.mark.parametrize("rate", [0.996, 1.003, 1.01])
def test_a_drift_is_said_with_its_size(rate: float) -> None:
    log = with_poses(LOG, at_rate(rate))
    for each in (log, of_commands(log)):
        found = found_in(each)
        assert found is not None
        assert found.spoils
        assert ("ahead of" if rate > 1.0 else "behind") in found.sentence
        assert found.evidence == pytest.approx(rate - 1.0, abs=0.0007)


def test_a_clock_that_goes_right_is_not_found() -> None:
    assert found_in(LOG) is None
    assert found_in(of_commands(LOG)) is None
    assert found_in(with_poses(LOG, lambda p: replace(p, t=p.t + 0.2))) is None  # late, but always by as much


def test_nothing_is_said_where_the_drive_shows_nothing() -> None:
    straight = sound_log(Drive(seconds=150.0, speeds=(1.0, 1.0), yaw_rates=(0.0, 0.0)))
    assert found_in(with_poses(straight, stepping(0.5))) is None
    short = sound_log(replace(SKID_STEERED, seconds=60.0))
    assert found_in(with_poses(short, stepping(0.5))) is None


def test_a_model_of_such_a_log_is_not_good() -> None:
    result = calibrate(with_poses(LOG, stepping(0.3)), input="wheel")
    assert not result.verdict.good
    assert "clock steps" in result.verdict.sentence


@pytest.mark.slow
@pytest.mark.parametrize("name", [*REAL, "../vehicles/warthog_2022-09-08", "warthog/grass_8_8_16h11s19"])
def test_nothing_is_found_in_any_two_minutes_of_a_real_log(name: str, real_log_dir: Path) -> None:
    log = open_log(real_log_dir / f"{name}.csv.gz")
    first, last = log.runs[0].poses.t[[0, -1]] - log.runs[0].span[0]
    cuts = [cut_to_span(log, start, start + 120.0) for start in np.arange(first, last - 60.0, 30.0)]
    wrong = [found for each in cuts for found in (found_in(each), found_in(of_commands(each))) if found]
    assert wrong == []


@pytest.mark.slow
@pytest.mark.parametrize("name", REAL)
def test_steps_and_drifts_of_real_logs_have_their_size(name: str, real_log_dir: Path) -> None:
    log = open_log(real_log_dir / f"{name}.csv.gz")
    whole = replace(log, runs=(max(log.runs, key=lambda each: len(each.poses)),))
    step, drift = (found_in(with_poses(whole, change)) for change in (stepping(0.3), at_rate(1.004)))
    assert step is not None
    assert drift is not None
    assert step.evidence == pytest.approx(0.3, abs=0.06)
    assert drift.evidence == pytest.approx(0.004, abs=0.0008)
