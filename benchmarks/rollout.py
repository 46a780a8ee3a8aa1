# SPDX-License-Identifier: Apache-2.0
"""Rollouts of 2048 x 100, 15 slip parameters: speed and accuracy beside rivals, on one core, and on a GPU."""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # one core for every rival alike

import numpy as np
from kernel import build
from numpy.typing import NDArray
from rollout_rivals import Floats, casadi_rival, jax_rival, numba_rival, numpy_rival
from simulated_log import simulated_log

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.models import Model
from slipwise.planning import Start, command_buffer, rollout, sample_futures

ROLLOUTS, PERIODS, DT = 2048, 100, 0.05
PROGRAMS = ("time_rollout", "time_mppi_motion")
SPEEDS = re.compile(r"thesis-15, no actuator\s+(\w+)\s+([\d.]+)")
LONGEST_CALL = 1.3  # from Python, in times of C++
GPU_PROGRAM = "time_gpu"
#: Whole MPPI iterations (sampling, rollouts of a drive without slip, costs) on an RTX 4090, as published by
#: Vlahov et al. 2024, "MPPI-Generic: A CUDA Library for Stochastic Trajectory Optimization",
#: arXiv:2409.07563. Not run here.
MPPI_GENERIC = 4.2


@dataclass(frozen=True)
class Figure:
    """One contender."""

    name: str
    giga_steps_per_second: float
    error: float | None  # largest distance of a last position to the core's in double [m]


def commands() -> NDArray[np.float32]:
    """Return commands that change from period to period, as MPPI draws them."""
    random = np.random.default_rng(1)
    buffer: NDArray[np.float32] = command_buffer(ROLLOUTS, PERIODS)
    buffer[:, :, 0] = 1.0 + 0.7 * random.uniform(-1.0, 1.0, (ROLLOUTS, PERIODS))
    buffer[:, :, 1] = 0.6 * random.uniform(-1.0, 1.0, (ROLLOUTS, PERIODS))
    return buffer


def learned() -> Model:
    """Learn the thesis's 15 parameters from a simulated log of wheel speeds, without an actuator."""
    settings = make_settings({"basis": "thesis-15", "learn_clock_offset": False})
    return calibrate(simulated_log(3.0, seed=1), input="wheel", settings=settings).model


def best(work: Callable[[], object], repeats: int) -> float:
    """Return the shortest time of several [s]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def figure(name: str, work: Callable[[], Floats], truth: Floats, repeats: int) -> Figure:
    """Time one contender after a first call, which may compile, and measure how far off it ends."""
    error = float(np.hypot(*(work()[:2].astype(np.float64) - truth[:2])).max())
    return Figure(name, ROLLOUTS * PERIODS / best(work, repeats) / 1e9, error)


def contenders(model: Model, drive: NDArray[np.float32], repeats: int) -> list[Figure]:
    """Time the core from Python and its rivals on the same commands."""
    truth = rollout(model, drive, DT, outputs=("end",), dtype=np.float64).end
    assert truth is not None
    p = model.mean.reshape(3, 5)
    v, omega = (np.ascontiguousarray(drive[:, :, i].T) for i in (0, 1))
    rows = np.ascontiguousarray(drive)
    ends, path = rollout(model, drive, DT, outputs=("end",)), rollout(model, drive, DT)

    def core(given: Floats, **options: str) -> Callable[[], Floats]:
        return lambda: np.asarray(rollout(model, given, DT, outputs=("end",), out=ends, **options).end)

    def whole_path() -> Floats:
        return np.asarray(rollout(model, drive, DT, out=path).path)[:, -1]

    found = [
        figure(f"slipwise, {level}", core(drive, level=level), truth, 20 * repeats)
        for level in _core.instruction_levels()
    ]
    found.append(figure("slipwise, commands [N, K, 2] row after row", core(rows), truth, 20 * repeats))
    found.append(figure("slipwise, all poses", whole_path, truth, 20 * repeats))
    rivals = {
        "numpy": numpy_rival(p, DT),
        "numba": numba_rival(p, DT),
        "JAX": jax_rival(p, DT),
        "casadi map": casadi_rival(p, DT, (PERIODS, ROLLOUTS)),
    }
    for name, rival in rivals.items():
        found.append(figure(name, lambda rival=rival: rival(v, omega), truth, repeats))  # type: ignore[misc]
    return found


def extra_costs(model: Model, drive: NDArray[np.float32], repeats: int) -> dict[str, float]:
    """Return the times of a covariance along every rollout, and of sampled futures [s]."""
    few = drive[:64]
    return {
        "covariance of every pose": best(
            lambda: rollout(model, drive, DT, outputs=("end",), covariance=True), repeats
        ),
        "all poses in float64": best(lambda: rollout(model, drive, DT, dtype=np.float64), repeats),
        "64 futures of 64 rollouts": best(
            lambda: sample_futures(model, few, DT, samples=64, seed=1), repeats
        ),
        "the call alone, one command": best(lambda: rollout(model, drive[:1, :1], DT, outputs=("end",)), 50),
    }


def on_gpu(
    model: Model, drive: NDArray[np.float32], repeats: int, folder: Path | None
) -> tuple[str, list[Figure]]:
    """Return what the C++ program measured on a GPU, and the call from Python, copies and all; or why not."""
    if reason := _core.why_no_gpu():
        return f"no GPU: {reason}", []
    folder = folder or build([GPU_PROGRAM], preset="cuda")
    printed = subprocess.run([str(folder / GPU_PROGRAM)], check=True, capture_output=True, text=True).stdout
    truth = rollout(model, drive, DT, outputs=("end",), dtype=np.float64).end
    assert truth is not None
    ends = rollout(model, drive, DT, outputs=("end",))

    def with_copies() -> Floats:
        return np.asarray(rollout(model, drive, DT, outputs=("end",), out=ends, device="cuda").end)

    return printed, [figure("slipwise, cuda, with copies", with_copies, truth, 20 * repeats)]


def euler_error(model: Model, drive: NDArray[np.float32]) -> float:
    """Return by how much Euler steps without slip miss the last positions [m]."""
    truth = np.asarray(rollout(model, drive, DT, outputs=("end",), dtype=np.float64, start=Start()).end)
    v, omega = (drive[:, :, i].astype(np.float64) for i in (0, 1))
    yaw = np.cumsum(omega * DT, axis=1) - omega * DT
    return float(
        np.hypot(
            (v * np.cos(yaw) * DT).sum(axis=1) - truth[0], (v * np.sin(yaw) * DT).sum(axis=1) - truth[1]
        ).max()
    )


def main() -> int:
    """Run the benchmark; exit code 1 when a call from Python takes more than its limit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file too")
    parser.add_argument("--quick", action="store_true", help="fewer repetitions")
    parser.add_argument(
        "--programs", type=Path, help="folder of the C++ benchmarks; they are built by default"
    )
    arguments = parser.parse_args()
    repeats = 3 if arguments.quick else 10
    folder = arguments.programs or build(list(PROGRAMS))
    printed = [
        subprocess.run([str(folder / name)], check=True, capture_output=True, text=True).stdout
        for name in PROGRAMS
    ]
    print("\n".join(printed))
    in_cpp = {level: float(speed) for level, speed in SPEEDS.findall(printed[0])}
    model, drive = learned(), commands()
    gpu, gpu_figures = on_gpu(model, drive, repeats, arguments.programs)
    print(gpu)
    print(f"MPPI-Generic, RTX 4090, as published (arXiv:2409.07563): {MPPI_GENERIC} e9 steps/s\n")
    figures = contenders(model, drive, repeats) + gpu_figures
    print(f"{'from Python, float but for casadi':44} {'1e9 steps/s':>12} {'largest error [m]':>18}")
    for f in figures:
        print(f"{f.name:44} {f.giga_steps_per_second:12.4f} {f.error:18.2g}")
    print(f"Euler steps without slip (MPPI's motion model) end up to {euler_error(model, drive):.2g} m off")
    extra = extra_costs(model, drive, repeats)
    for name, seconds in extra.items():
        print(f"{name:44} {1e3 * seconds:12.3f} ms")
    level = _core.instruction_levels()[-1]
    ratio = in_cpp[level] / next(f.giga_steps_per_second for f in figures if f.name == f"slipwise, {level}")
    print(f"a call from Python takes {ratio:.2f} times C++ (at most {LONGEST_CALL})")
    if arguments.json:
        content = {
            "contenders": [asdict(f) for f in figures],
            "in_cpp": in_cpp,
            "seconds": extra,
            "call_ratio": ratio,
            "gpu": gpu,
        }
        arguments.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return int(ratio > LONGEST_CALL)


if __name__ == "__main__":
    sys.exit(main())
