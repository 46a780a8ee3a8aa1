# SPDX-License-Identifier: Apache-2.0
"""Two sources whose tracks differ in size are found with the ratio, and no arm or lateness passes for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_noise import lasting_noise
from sample_sources import Source, run_of, seen_by, true_run

from slipwise.calibration import calibrate
from slipwise.logs import Log, Poses, Run, open_log
from slipwise.logs.findings.diagnose import diagnose_log
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.findings.source_scale import SourceScale

ARM, LATE = (0.5, -0.3, 0.1), 0.15
REAL = ("husky/tile_deflated_tyres", "warthog/grass_7_29_14h46s15", "f1tenth/DS4", "slipx/car_2.0")


def found_in(*runs: Run) -> Finding | None:
    return SourceScale().look_at(WholeLog(Log(runs), "wheel"))


def beside(run: Run, scale: float, std: float = 0.02, lasting: float = 0.0) -> Run:
    """Return the run with a source beside its poses, in another frame and so many times as large."""
    random, p = np.random.default_rng(3), run.poses
    seen = seen_by(p, Source(std=(0.0, 0.0), late=LATE, sensor=ARM), random)
    noise = lasting_noise(seen.t, lasting, random, 2) if lasting else random.standard_normal((len(seen), 2))
    # The arm is scaled too, as a map does it.
    x, y = scale * seen.x + std * noise[:, 0], scale * seen.y + std * noise[:, 1]
    cos, sin = np.cos(0.7), np.sin(0.7)
    other = replace(seen, x=cos * x - sin * y + 40.0, y=sin * x + cos * y, yaw=seen.yaw + 0.7)
    return run_of(run, p, map=other)


def drive() -> Run:
    run, random = true_run(1)
    return replace(run, poses=seen_by(run.poses, Source(), random))


@pytest.mark.parametrize("scale", [0.94, 1.03, 1.06])
def test_another_scale_is_said_with_the_ratio(scale: float) -> None:
    found = found_in(beside(drive(), scale))
    assert found is not None
    assert found.spoils
    assert found.evidence == pytest.approx(scale, abs=0.006)
    assert found.sentence.startswith(f"the track of map is {scale:.2f}")
    assert "as large as that of first, over " in found.sentence
    assert "--pose-topic" in " ".join(found.advice)


def test_a_minute_that_both_see_tells_a_scale_of_a_tenth() -> None:
    def short(scale: float) -> Finding | None:
        run = beside(drive(), scale)
        begun = run.poses.t < run.poses.t[0] + 60.0
        return found_in(replace(run, poses=run.poses.select(begun)))

    found = short(1.1)
    assert found is not None
    assert found.evidence == pytest.approx(1.1, abs=0.03)
    assert short(1.0) is None


def test_an_arm_lateness_and_noise_are_no_scale() -> None:
    assert found_in(beside(drive(), 1.0)) is None
    assert found_in(beside(drive(), 1.0, std=0.3)) is None
    assert found_in(beside(drive(), 1.0, std=0.2, lasting=20.0)) is None
    assert found_in(drive()) is None


def test_nothing_is_said_on_a_circle_where_an_arm_is_like_a_scale() -> None:
    t = np.arange(0.0, 120.0, 0.1)
    yaw = 0.5 * t
    circle = Poses(t, 2.0 * np.sin(yaw), -2.0 * np.cos(yaw), yaw, np.zeros(len(t), np.int64))
    for scale in (1.0, 1.06):
        assert found_in(beside(Run("circle", None, None, circle), scale)) is None


def test_a_model_of_such_sources_is_not_good() -> None:
    log = Log((beside(drive(), 1.06),))
    result = calibrate(log, input="wheel")
    assert not result.verdict.good
    assert "times as large as that of first" in result.verdict.sentence
    assert "source-scale" in {each.kind for each in diagnose_log(log)}
    assert "source-scale" not in {each.kind for each in diagnose_log(Log((beside(drive(), 1.0),)))}


@pytest.mark.slow
@pytest.mark.parametrize("name", REAL)
def test_a_larger_map_beside_a_real_log_is_found(name: str, real_log_dir: Path) -> None:
    folder = real_log_dir.parent / "foreign" if name.startswith("slipx") else real_log_dir
    runs = open_log(folder / f"{name}.csv.gz").runs
    assert found_in(*(beside(run, 1.0) for run in runs)) is None
    found = found_in(*(beside(run, 1.06) for run in runs))
    assert found is not None
    assert found.evidence == pytest.approx(1.06, abs=0.01)
