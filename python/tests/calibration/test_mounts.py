# SPDX-License-Identifier: Apache-2.0
"""Where a further source of poses sits, and how late it is, from simulated rigs and real logs."""

from __future__ import annotations

from collections.abc import Iterable
from copy import deepcopy
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from sample_models import make_model, named
from sample_noise import lasting_noise
from sample_sources import Source, run_of, seen_by, true_run

from slipwise.calibration import Calibration, calibrate
from slipwise.calibration.calibrate_sequence import calibrate_sequence
from slipwise.calibration.mount_windows import LATE, YAW, X, Y
from slipwise.calibration.mounts import MountWatch, holding_mounts, mounts_of
from slipwise.calibration.source_tables import PoseSourceTable
from slipwise.export import export_model
from slipwise.logs import Log, Poses, Run, open_log
from slipwise.models.difference import differences
from slipwise.models.model import load_model
from slipwise.models.mounted import mounts_in
from slipwise.models.summary import summarise

ARM, TURNED, LATER = (0.45, -0.2), 0.035, 0.12


Drive = tuple[Run, np.random.Generator]


@pytest.fixture(scope="module")
def drives() -> list[Drive]:
    return [true_run(seed) for seed in range(100)]


def rig(drive: Drive, lasting: float = 0.0) -> tuple[Run, np.ndarray]:
    """Return a drive that two sources saw, and the pose and lateness of the second.

    Their noise is white, or correlated over a time [s].
    """
    run, random = drive[0], deepcopy(drive[1])
    truth = random.uniform((-0.6, -0.4, -0.15, -0.25), (0.6, 0.4, 0.15, 0.25))
    sources = Source(), Source(std=(0.02, 0.01), late=truth[LATE], sensor=tuple(truth[:LATE].tolist()))
    if lasting == 0.0:
        first, second = (seen_by(run.poses, source, random) for source in sources)
    else:
        first, second = (lastingly_seen_by(run.poses, source, lasting, random) for source in sources)
    return run_of(run, first, other=second), truth


def lastingly_seen_by(poses: Poses, source: Source, tau: float, random: np.random.Generator) -> Poses:
    """Return what a source measures whose noise is correlated over a time `tau` [s]."""
    seen = seen_by(poses, replace(source, std=(0.0, 0.0)), random)
    noise = lasting_noise(seen.t, tau, random, 3) * (source.std[0], source.std[0], source.std[1])
    return replace(seen, x=seen.x + noise[:, 0], y=seen.y + noise[:, 1], yaw=seen.yaw + noise[:, 2])


def of_many(rigs: Iterable[tuple[Run, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors and standard deviations of the mounts of rigs, both [N, 4]."""
    errors, stds = [], []
    for run, truth in rigs:
        (mount,) = mounts_of([run])
        errors.append(mount.value - truth)
        stds.append(mount.std)
    return np.array(errors), np.array(stds)


@pytest.mark.slow
def test_intervals_of_many_rigs_hold_the_truth_and_are_small(drives: list[Drive]) -> None:
    errors, stds = of_many(rig(drive) for drive in drives)
    held = {k: np.mean(np.abs(errors) < k * stds) for k in (1.645, 1.96)}
    assert 0.86 <= held[1.645] <= 0.96, held
    assert 0.92 <= held[1.96] <= 0.98, held
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert max(rms[X], rms[Y]) < 0.01
    assert np.degrees(rms[YAW]) < 0.1
    assert rms[LATE] < 0.005


@pytest.mark.slow
@pytest.mark.parametrize("lasting", [2.0, 10.0])
def test_intervals_hold_the_truth_of_each_number_where_noise_lasts(
    drives: list[Drive], lasting: float
) -> None:
    errors, stds = of_many(rig(drive, lasting) for drive in drives)
    held = np.mean(np.abs(errors) < 1.96 * stds, axis=0)
    assert 0.92 <= held.mean() <= 0.98, held
    assert held.min() > 0.85, held


def beside_its_copy(log: Log, random: np.random.Generator, std: tuple[float, float]) -> Log:
    """Return a log beside a copy of its poses, shifted on the robot, turned and late."""
    runs = []
    for run in log.runs:
        p, noise = run.poses, random.standard_normal((3, len(run.poses)))
        cos, sin = np.cos(p.yaw), np.sin(p.yaw)
        copy = Poses(
            t=p.t + LATER,
            x=p.x + ARM[0] * cos - ARM[1] * sin + std[0] * noise[0],
            y=p.y + ARM[0] * sin + ARM[1] * cos + std[0] * noise[1],
            yaw=p.yaw + TURNED + std[1] * noise[2],
            frame=p.frame,
        )
        runs.append(replace(run, others={"copy": copy}, source="first"))
    return replace(log, runs=tuple(runs))


@pytest.mark.parametrize(
    "name", ["husky/tile_deflated_tyres", "warthog/grass_7_29_14h46s15", "robotino/table_gray"]
)
def test_a_shifted_copy_of_a_real_log_gives_the_shift(name: str, real_log_dir: Path) -> None:
    log = open_log(real_log_dir / f"{name}.csv.gz")
    (mount,) = mounts_of(beside_its_copy(log, np.random.default_rng(1), (0.01, 0.005)).runs)
    truth = np.array((*ARM, TURNED, LATER))
    assert np.all(np.abs(mount.value - truth) < 3.0 * mount.std), (mount.value, mount.std)
    assert np.all(mount.std < (0.01, 0.01, 0.002, 0.005))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["husky/tile_deflated_tyres", "warthog/grass_7_29_14h46s15"])
def test_a_shifted_copy_of_a_real_log_does_no_harm_where_nobody_says_where_it_sits(
    name: str, real_log_dir: Path
) -> None:
    log = open_log(real_log_dir / f"{name}.csv.gz")
    both = beside_its_copy(log, np.random.default_rng(1), (0.01, 0.005))
    alone, beside = (calibrate(each, input="wheel") for each in (log, both))
    assert np.all(errors_of(beside) < 1.15 * errors_of(alone)), (errors_of(alone), errors_of(beside))
    assert [mount.name for mount in beside.mounts] == ["copy"]
    assert "copy sits 0.4" in str(summarise(beside.model))


def errors_of(calibration: Calibration) -> np.ndarray:
    held_out = calibration.model.content.verdict.held_out
    assert held_out is not None
    return np.array((held_out.position, held_out.heading))


def moved_on(later: float, poses: Poses) -> Poses:
    return replace(poses, t=poses.t + later)


def test_a_drive_that_is_taken_in_stretches_gives_what_the_whole_drive_gives() -> None:
    run, _ = rig(true_run(4))
    (whole,) = mounts_of([run])
    watch = MountWatch()
    begin, end = run.span
    for until in np.arange(begin + 60.0, end + 60.0, 60.0):  # each looks back by two minutes
        watch.take(
            run.with_each_source(lambda each, t=until: each.select((each.t > t - 120.0) & (each.t <= t)))
        )
    (mount,) = watch.mounts()
    assert np.all(np.abs(mount.value - whole.value) < 0.5 * whole.std)
    assert mount.std == pytest.approx(whole.std, rel=0.3)
    assert 0.75 * whole.seconds < mount.seconds <= whole.seconds
    for later in 1000.0 * np.arange(1, 40):  # the same drive again and again
        watch.restart()
        watch.take(run.with_each_source(partial(moved_on, later)))
    (longer,) = watch.mounts()
    assert longer.seconds > 30.0 * whole.seconds
    assert np.all(np.abs(longer.value - whole.value) < whole.std)


def test_positions_alone_tell_an_arm_and_no_heading() -> None:
    run, truth = rig(true_run(3))
    positions = replace(run.others["other"], course=True)
    (mount,) = mounts_of([replace(run, others={"other": positions})])
    assert np.all(np.abs(mount.value - truth)[[X, Y, LATE]] < 0.03)
    assert mount.mounted().yaw is None


def test_a_drive_straight_ahead_does_not_tell_an_arm() -> None:
    t = np.arange(0.0, 120.0, 0.1)
    zero = np.zeros(len(t))
    random = np.random.default_rng(2)

    def poses(ahead: float) -> Poses:
        noise = 0.01 * random.standard_normal((3, len(t)))
        frame = np.zeros(len(t), np.int64)
        return Poses(t=t, x=t + ahead + noise[0], y=zero + noise[1], yaw=zero + noise[2], frame=frame)

    run = Run("straight", None, None, poses(0.0), others={"other": poses(0.5)}, source="first")
    (mount,) = mounts_of([run])
    found = mount.mounted()
    assert found.x is None
    assert found.y is None
    assert found.late is None
    assert found.yaw is not None
    assert abs(found.yaw[0]) < 0.002
    unknown = "how far ahead and how far to a side other sits"
    assert f" s beside first do not tell {unknown}: turn more" in mount.untold()


def test_a_model_keeps_mounts_and_says_which_sensor_was_moved(drives: list[Drive], tmp_path: Path) -> None:
    models, moved = [], (0.0, 0.05)
    for ahead, (run, random) in zip(moved, drives, strict=False):
        random = deepcopy(random)
        rtk = Source(std=(0.02, 0.01), late=LATER, sensor=(ARM[0] + ahead, ARM[1], TURNED))
        seen = seen_by(run.poses, Source(), random), seen_by(run.poses, rtk, random)
        models.append(
            holding_mounts(make_model(named("edd-2")), mounts_of([run_of(run, seen[0], rtk=seen[1])]))
        )
    kept = load_model(models[0].save(tmp_path / "model.yaml"))
    assert kept == models[0]
    assert "rtk sits 0.4" in str(summarise(kept))
    (mount,) = mounts_in(kept)
    told = [each[0] for each in (mount.x, mount.y, mount.yaw, mount.late) if each]
    assert np.allclose(told, (*ARM, TURNED, LATER), atol=0.01)
    assert "[[pose_sources]]" in export_model(kept, "mounts", name="m", force=True).text
    (found,) = [row for row in differences(*models) if row.different]
    assert found.name.startswith("sensor_x(rtk")


def test_a_memory_of_surfaces_loses_no_mount(drives: list[Drive]) -> None:
    run, random = drives[0]
    rtk = seen_by(run.poses, Source(std=(0.02, 0.01), late=LATER, sensor=(*ARM, TURNED)), deepcopy(random))
    log = Log((run_of(run, seen_by(run.poses, Source(), deepcopy(random)), rtk=rtk),))
    found, _ = calibrate_sequence([log], input="wheel")
    plain = calibrate(log, input="wheel")
    assert [each.name for each in found.mounts] == ["rtk"]
    assert mounts_in(found.model) == mounts_in(plain.model)
    assert found.notes == plain.notes


def test_the_place_of_a_source_is_learned_unless_the_settings_give_one() -> None:
    tables = ({"name": "a"}, {"name": "a", "x": 0.3}, {"name": "a", "x": 0.3, "learn_extrinsics": True})
    assert [PoseSourceTable.model_validate(table).learns_place for table in tables] == [True, False, True]
