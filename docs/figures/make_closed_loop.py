# SPDX-License-Identifier: Apache-2.0
"""Draws docs/results.md's figure: paths over a course whose floor changes, and the error over time."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.files import write_whole
from slipwise.reporting.png_picture import drawing_part, small_png
from slipwise_sim.demo.closed_loop import (
    EACH_FLOOR,
    FIRST_FLOOR,
    LIVE,
    VENDOR,
    Driven,
    drive_all,
    floor_model,
)
from slipwise_sim.demo.slalom_course import FLOORS, SlalomCourse, slalom_course

SEED = 1
SHOWN = (VENDOR, FIRST_FLOOR, LIVE, EACH_FLOOR)
COLOURS = {VENDOR: "#d55e00", FIRST_FLOOR: "#cc79a7", LIVE: "#0072b2", EACH_FLOOR: "#222222"}
SHADES = {"gravel": "#eee3cf", "wet grass": "#d5e8cf", "concrete": "#e2e4e8"}
SMOOTH = 5.0  # [s] over which the error is averaged
LONGEST = 130.0  # [s] that are drawn; only the vendor's constants take longer
SIZE, DPI, LARGEST = (9.0, 6.2), 110, 150_000  # [in], [1/in], [bytes]


def draw_paths(axes: Any, course: SlalomCourse, driven: dict[str, Driven]) -> None:
    """Draw the course with its floors, and where each variant drove."""
    edges = (0.0, *course.changes, float(course.points[-1, 0]))
    for floor, begin, end in zip(course.floors, edges[:-1], edges[1:], strict=True):
        axes.axvspan(begin, end, color=SHADES[floor.name], linewidth=0)
        axes.text(begin + 1.0, 3.3, floor.name, va="top")
    axes.plot(*course.points.T, color="black", linewidth=4.0, alpha=0.18, label="reference")
    for name in SHOWN:
        axes.plot(*driven[name].trace.xy.T, color=COLOURS[name], linewidth=1.3, label=name)
    axes.set(xlim=(0.0, edges[-1]), ylim=(-3.5, 3.5), xlabel="x [m]", ylabel="y [m]")
    axes.legend(loc="lower center", ncols=5, frameon=False, fontsize=8, bbox_to_anchor=(0.5, 1.0))


def draw_errors(axes: Any, driven: dict[str, Driven]) -> None:
    """Draw the mean cross-track error of the last seconds over time; dots are changes of floor."""
    for name in SHOWN:
        trace = driven[name].trace
        error = np.abs(trace.left)
        width = round(SMOOTH / (trace.t[1] - trace.t[0]))
        total = np.concatenate(([0.0], np.cumsum(error)))
        last = np.maximum(np.arange(len(error)) + 1 - width, 0)
        smooth = (total[1:] - total[last]) / (np.arange(len(error)) + 1 - last)
        drawn = trace.t <= LONGEST
        axes.semilogy(trace.t[drawn], smooth[drawn], color=COLOURS[name], linewidth=1.5)
        changes = np.flatnonzero(np.diff(trace.floor) > 0)
        changes = changes[trace.t[changes] <= LONGEST]
        axes.plot(trace.t[changes], smooth[changes], "o", color=COLOURS[name], markersize=5)
    axes.set(xlim=(0.0, LONGEST), ylim=(0.005, 2.0), xlabel="time [s]")
    axes.set_ylabel(f"cross-track error [m], mean of {SMOOTH:g} s")
    axes.grid(visible=True, which="major", alpha=0.3)


def save(path: Path, picture: bytes) -> None:
    """Write the bytes of a picture."""
    path.write_bytes(picture)


def main(folder: Path) -> Path:
    """Write the figure into `folder`; return its path."""
    driven = drive_all(SEED, [floor_model(floor) for floor in FLOORS])
    figure = drawing_part("figure").Figure(figsize=SIZE, layout="constrained")
    above, below = figure.subplots(2, 1)
    draw_paths(above, slalom_course(SEED), driven)
    draw_errors(below, driven)
    path = folder / "closed-loop.png"
    picture = small_png(figure, dpi=DPI, largest=LARGEST)
    write_whole(path, lambda target: save(target, picture))
    return path


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
