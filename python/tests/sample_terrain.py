# SPDX-License-Identifier: Apache-2.0
"""Made-up surfaces: each shakes at a frequency of its own and draws a current of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipwise.terrain import Recording, Stream

SURFACES = {"grass": (6.0, 3.0), "gravel": (18.0, 5.0), "tiles": (33.0, 2.0)}  # Hz, A
IMU_RATE, DRIVE_RATE = 100.0, 10.0  # Hz


def made_recording(name: str, surface: str, *, seconds: float = 20.0, seed: int = 0) -> Recording:
    """Return a drive over a surface, with size and speed of its own."""
    rng = np.random.default_rng([seed, *name.encode()])
    frequency, amperes = SURFACES[surface]
    size, speed = rng.uniform(0.8, 1.2), rng.uniform(0.3, 0.5)
    t = np.arange(0.0, seconds, 1.0 / IMU_RATE)
    shaking = np.sin(2.0 * np.pi * frequency * t[:, None] + rng.uniform(0.0, 6.0, 6))
    imu = size * shaking + 0.2 * rng.standard_normal((len(t), 6))
    drive_t = np.arange(0.0, seconds, 1.0 / DRIVE_RATE)
    currents = amperes * size * (1.0 + 0.1 * rng.standard_normal((len(drive_t), 2)))
    drive = np.column_stack([np.abs(currents), np.full((len(drive_t), 2), speed)])
    labels = np.full(len(drive_t), surface, dtype=object)
    return Recording(name, Stream(t, imu), Stream(drive_t, drive), drive_t, labels)


def made_recordings(*, runs: int = 3, seconds: float = 20.0, seed: int = 0) -> list[Recording]:
    """Return several drives over each surface."""
    return [
        made_recording(f"{surface}_{k}", surface, seconds=seconds, seed=seed)
        for surface in SURFACES
        for k in range(runs)
    ]


def write_tables(folder: Path, recordings: list[Recording]) -> tuple[Path, Path]:
    """Write the recordings as a table of the IMU and one of the currents, which names the surface."""
    imu, drive = ["run,time,wx,wy,wz,ax,ay,az"], ["run,time,curL,curR,velL,velR,terrain"]
    for recording in recordings:
        assert recording.imu is not None
        assert recording.drive is not None
        for t, values in zip(recording.imu.t, recording.imu.values, strict=True):
            imu.append(f"{recording.run},{t:.3f}," + ",".join(f"{value:.6g}" for value in values))
        for t, values, label in zip(recording.drive.t, recording.drive.values, recording.labels, strict=True):
            cells = ",".join(f"{value:.6g}" for value in values)
            drive.append(f"{recording.run},{t:.3f},{cells},{label}")
    paths = folder / "imu.csv", folder / "currents.csv"
    for path, lines in zip(paths, (imu, drive), strict=True):
        path.write_text("\n".join(lines) + "\n")
    return paths
