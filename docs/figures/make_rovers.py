# SPDX-License-Identifier: Apache-2.0
"""Draws the figure of docs/vehicles.md: two vehicles on steered wheels, and how true their slip is."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.rover_recovery import CASES, Case, Recovery, recover

from slipwise import _core
from slipwise.files import write_whole
from slipwise.reporting.png_picture import drawing_part, small_png
from slipwise_sim.engine import load_mujoco
from slipwise_sim.rover import RoughGround, rover_mjcf
from slipwise_sim.rover_drive import joint_targets, rover_commands

SHOWN = (CASES[2], CASES[0])  # a rover on stones, a swerve base
DRIVES = 6
SIZE, DPI, LARGEST = (9.0, 6.0), 110, 200_000  # [in], [1/in], [bytes]
PICTURE, SHOT = (420, 640), 190  # [pixels]; periods until the picture is taken


def picture_of(case: Case) -> Any:
    """Return what a camera beside the vehicle sees, [height, width, 3]; a display or EGL is needed."""
    os.environ.setdefault("MUJOCO_GL", "egl")
    mujoco = load_mujoco()
    ground = RoughGround(case.stones, height=0.05, seed=1)
    model = mujoco.MjModel.from_xml_string(rover_mjcf(case.rover, ground))
    data = mujoco.MjData(model)
    for target in joint_targets(case.rover, rover_commands(case.rover, 30.0, 3))[:SHOT]:
        data.ctrl = target
        mujoco.mj_step(model, data, nstep=25)
    renderer = mujoco.Renderer(model, *PICTURE)
    renderer.update_scene(data, camera="chase")
    return renderer.render()


def draw_recovery(axes: Any, case: Case, drives: list[Recovery]) -> None:
    """Draw each drive's parameters with three standard deviations, and the true ones as crosses."""
    basis = _core.named_basis(case.basis)
    names = [f"{c}.{term}" for c in ("lon", "lat", "ang") for term in getattr(basis, c)]
    for k, drive in enumerate(drives):
        at = np.arange(len(names)) + 0.1 * (k - (len(drives) - 1) / 2.0)
        axes.errorbar(
            at,
            drive.value,
            3.0 * drive.std,
            fmt=".",
            color="#0072b2",
            linewidth=1.0,
            label=_once(k, "learned"),
        )
        axes.plot(at, drive.truth, "x", color="#d55e00", markersize=4, label=_once(k, "true"))
    axes.axhline(0.0, color="black", linewidth=0.5)
    axes.set_xticks(np.arange(len(names)), names, fontsize=8)
    axes.set(ylabel="slip parameter", title=case.name)
    axes.grid(visible=True, axis="y", alpha=0.3)


def _once(number: int, label: str) -> str:
    return label if number == 0 else "_" + label


def save(path: Path, picture: bytes) -> None:
    """Write the bytes of a picture."""
    path.write_bytes(picture)


def main(folder: Path) -> Path:
    """Write the figure into `folder`; return its path."""
    figure = drawing_part("figure").Figure(figsize=SIZE, layout="constrained")
    above, below = figure.subplots(2, len(SHOWN))
    for case, picture, recovery in zip(SHOWN, above, below, strict=True):
        picture.imshow(picture_of(case))
        picture.axis("off")
        draw_recovery(recovery, case, [recover(case, seed) for seed in range(1, DRIVES + 1)])
    below[0].legend(loc="upper center", frameon=False, fontsize=8, ncols=2)
    path = folder / "rovers.png"
    picture = small_png(figure, dpi=DPI, largest=LARGEST)
    write_whole(path, lambda target: save(target, picture))
    return path


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
