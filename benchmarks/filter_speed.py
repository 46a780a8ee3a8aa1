# SPDX-License-Identifier: Apache-2.0
"""How long learning 10 parameters from a 10-minute, 20 Hz log takes: core, whole command, numpy, filterpy."""

from __future__ import annotations

import argparse
import functools
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import filterpy_filter
import numpy as np
import numpy_filter
from numpy_filter import Floats, Noise, Window
from simulated_log import BASIS, simulated_log

from slipwise import _core
from slipwise.calibration.prepared_run import WindowSet, collect_windows, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.logs import Log, save_log

MINUTES = 10.0
ITERATIONS = 2
SPEEDS = (1.5, 0.6)  # reference speeds of the prior, m/s and rad/s
NOISE = Noise(np.full(3, 1e-3), np.full(3, 0.05), 0.02, 0.01)
TEN_PARAMETERS = f'basis = "{BASIS}"\nlearn_clock_offset = false\n'
SAME = 1e-9  # the filters must agree to this, relative to the parameters' standard deviations
WINDOW_LENGTHS = (1.0, 5.0)  # s


@dataclass(frozen=True)
class Figure:
    """One measurement."""

    name: str
    milliseconds: float  # best of several
    limit: float | None = None  # ms
    ratio: float | None = None  # to the same work in the core


@dataclass(frozen=True, eq=False)
class Job:
    """What all filters are given."""

    windows: WindowSet
    plain: list[Window]  # the same windows as arrays
    model: _core.MotionModel
    prior: _core.Estimate
    shape: _core.MotionNoise
    settings: _core.IekfSettings


def make_job(log: Log, length: float) -> Job:
    """Cut the log into windows of `length` [s]; the noise is Gaussian, so nothing is left out."""
    windows = collect_windows(prepare_run(log, "wheel"), length, Settings().rules())
    model = _core.MotionModel(_core.named_basis(BASIS), False, False)
    settings = _core.IekfSettings()
    settings.iterations, settings.tolerance, settings.huber, settings.gate = ITERATIONS, 0.0, 1e9, 1e18
    shape = _core.MotionNoise(
        [0.0] * 3,
        NOISE.psd_motion.tolist(),
        NOISE.fraction.tolist(),
        NOISE.pose_std_xy,
        NOISE.pose_std_yaw,
    )
    inputs = windows.drive[0].inputs
    plain = [
        _window(inputs.t, inputs.v, inputs.omega, (start, end), measured)
        for start, end, measured in zip(
            windows.start.tolist(), windows.end.tolist(), windows.measured, strict=True
        )
    ]
    prior = _core.prior_estimate(model, *SPEEDS, _core.PriorSettings())
    return Job(windows, plain, model, prior, shape, settings)


def core_average(log: Log, length: float) -> Callable[[], None]:
    """Return the pass that `slipwise calibrate` makes: adapting priors and noise, one basis."""
    settings = Settings(basis=BASIS, learn_clock_offset=False)
    windows = collect_windows(prepare_run(log, "wheel"), length, settings.rules())
    filters = (settings.filter_settings(), _core.ModelAverageSettings())

    def work() -> None:
        average = _core.ModelAverage(BASIS, settings.bases(), False, False, False, *filters)
        for history, segment in zip(windows.histories, windows.segments, strict=True):
            average.learn(history, segment)

    return work


def core_filter(job: Job) -> tuple[Floats, Floats]:
    """Learn all windows with the core's IEKF."""
    estimate = job.prior
    for history, segment in zip(job.windows.histories, job.windows.segments, strict=True):
        path = _core.integrate_segment(job.model, estimate.mean, history, segment, _core.Integrator.Exact)
        cov_z = _core.slip_covariance(path, job.shape) + _core.pose_noise_covariance(
            segment.measured, job.shape
        )
        estimate = _core.iekf_update(job.model, estimate, history, segment, cov_z, job.settings).estimate
    return np.array(estimate.mean), np.array(estimate.covariance)


def plain_filter(job: Job) -> tuple[Floats, Floats]:
    """Learn all windows with the same filter in numpy."""
    mean, covariance = np.array(job.prior.mean), np.array(job.prior.covariance)
    for window in job.plain:
        cov_z = numpy_filter.window_noise(window, mean, NOISE)
        mean, covariance = numpy_filter.iekf_update(mean, covariance, window, cov_z, ITERATIONS)
    return mean, covariance


def filterpy_pass(job: Job) -> tuple[Floats, Floats]:
    """Learn all windows with filterpy's filter and the measurement model in numpy."""
    ekf = filterpy_filter.make_filter(np.array(job.prior.mean), np.array(job.prior.covariance))
    for window in job.plain:
        cov_z = numpy_filter.window_noise(window, ekf.x, NOISE)
        filterpy_filter.iekf_update(ekf, window, cov_z, ITERATIONS)
    return np.asarray(ekf.x), np.asarray(ekf.P)


def largest_difference(job: Job) -> float:
    """Return by how much the three filters' results differ, in the core's standard deviations."""
    mean, covariance = core_filter(job)
    std = np.sqrt(np.diag(covariance))
    differences = []
    for other_mean, other_covariance in (plain_filter(job), filterpy_pass(job)):
        differences.append(np.abs((other_mean - mean) / std).max())
        differences.append(np.abs((other_covariance - covariance) / np.outer(std, std)).max())
    return float(max(differences))


def time_passes(log: Log, length: float, repeats: int) -> list[Figure]:
    """Time the whole pass over the log in all three filters."""
    job = make_job(log, length)
    difference = largest_difference(job)
    words = f"{len(job.plain)} windows of {length:g} s"
    print(f"{words}: core, numpy and filterpy agree to {difference:.1e} standard deviations")
    if difference > SAME:
        raise SystemExit(f"the filters differ by more than {SAME}: their times cannot be compared")
    core = best(lambda: core_filter(job), repeats)
    return [
        Figure(
            f"calibration in the core, as shipped, {words}", best(core_average(log, length), repeats), 50.0
        ),
        Figure(f"IEKF pass in the core, {words}", core),
        Figure(f"IEKF pass in numpy, {words}", *beside(best(lambda: plain_filter(job), 3), core)),
        Figure(f"IEKF pass in filterpy + numpy, {words}", *beside(best(lambda: filterpy_pass(job), 3), core)),
    ]


def time_update(log: Log, repeats: int) -> list[Figure]:
    """Time one update on a window of 100 steps, two iterations."""
    job = make_job(log, 5.0)
    middle = len(job.plain) // 2
    segment, window, history = job.windows.segments[middle], job.plain[middle], job.windows.drive[0].history
    mean, covariance = np.array(job.prior.mean), np.array(job.prior.covariance)
    cov_z = numpy_filter.window_noise(window, mean, NOISE)

    def with_filterpy() -> None:
        ekf = filterpy_filter.make_filter(mean, covariance)
        filterpy_filter.iekf_update(ekf, window, cov_z, ITERATIONS)

    def with_numpy() -> None:
        numpy_filter.iekf_update(mean, covariance, window, cov_z, ITERATIONS)

    def with_core() -> None:
        _core.iekf_update(job.model, job.prior, history, segment, cov_z, job.settings)

    words = f"one update, {len(window.v)} steps, {ITERATIONS} iterations"
    core = best(with_core, 100 * repeats)
    return [
        Figure(f"{words}, core called from Python", core, 0.030),
        Figure(f"{words}, numpy", *beside(best(with_numpy, 10 * repeats), core)),
        Figure(f"{words}, filterpy + numpy", *beside(best(with_filterpy, 10 * repeats), core)),
    ]


def time_command(log: Log, repeats: int) -> list[Figure]:
    """Time the whole command, start-up included, in a process of its own."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        save_log(log, folder / "drive.csv")
        settings = folder / "ten.toml"
        settings.write_text(TEN_PARAMETERS, encoding="utf-8")
        calibrate = ["calibrate", str(folder / "drive.csv"), "--no-report", "--runs", str(folder / "runs")]
        calibrate += ["-o", str(folder / "model.yaml")]
        rows: tuple[tuple[str, list[str], float | None], ...] = (
            ("slipwise --version", ["--version"], None),
            (
                "slipwise calibrate, 10 parameters, no report",
                [*calibrate, "--settings", str(settings)],
                2000.0,
            ),
            ("slipwise calibrate, as by default (auto), no report", calibrate, None),
        )
        return [
            Figure(f"whole command: {words}", best(functools.partial(run_command, given), repeats), limit)
            for words, given, limit in rows
        ]


def run_command(arguments: list[str]) -> None:
    """Run slipwise; a verdict of not good enough (1) is no failure here."""
    done = subprocess.run(
        [sys.executable, "-m", "slipwise", *arguments], capture_output=True, text=True, check=False
    )
    if done.returncode not in (0, 1):
        raise SystemExit(f"slipwise {arguments[0]} failed: {done.stderr.strip()[-500:]}")


def best(work: Callable[[], object], repeats: int) -> float:
    """Return the shortest time of several [ms]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def beside(milliseconds: float, core: float) -> tuple[float, None, float]:
    """Return time, no limit, and the ratio to the core's time."""
    return milliseconds, None, milliseconds / core


def _window(t: Floats, v: Floats, omega: Floats, span: tuple[float, float], measured: Floats) -> Window:
    """Cut held inputs to one window, split where they change."""
    start, end = span
    first, last = int(np.searchsorted(t, start, side="right")) - 1, int(np.searchsorted(t, end))
    edges = np.concatenate(([start], t[first + 1 : last], [end]))
    return Window(v[first:last], omega[first:last], np.diff(edges), measured)


def print_figures(figures: list[Figure]) -> None:
    """Print the table."""
    print(f"\n{'':66} {'best [ms]':>10} {'limit [ms]':>11}  ratio to the core")
    for f in figures:
        limit = "" if f.limit is None else f"{f.limit:.3g}"
        verdict = "" if f.limit is None else ("reached" if f.milliseconds <= f.limit else "MISSED")
        print(
            f"{f.name:66} {f.milliseconds:10.4g} {limit:>11}  "
            + (verdict if f.ratio is None else f"{f.ratio:.1f} x")
        )


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file too")
    parser.add_argument("--quick", action="store_true", help="fewer repetitions")
    arguments = parser.parse_args()
    repeats = 3 if arguments.quick else 20
    log = simulated_log(MINUTES, seed=1)
    figures = time_update(log, repeats)
    for length in WINDOW_LENGTHS:
        figures += time_passes(log, length, repeats)
    figures += time_command(log, 1 if arguments.quick else 5)
    print_figures(figures)
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(f) for f in figures], indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
