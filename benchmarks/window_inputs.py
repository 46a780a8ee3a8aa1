# SPDX-License-Identifier: Apache-2.0
"""Windows as a regression sees them: inputs in bins, the speed at the start, headings that do not wrap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.prepared_run import PreparedRun, WindowSet
from slipwise.logs.held import HeldSum

Floats = NDArray[np.float64]

BINS = 6  # over a window
BINS_BEFORE, SECONDS_BEFORE = 2, 1.0  # what may still be in the delay when the window begins


def window_inputs(windows: WindowSet) -> Floats:
    """Return the mean (v, vy, omega) in bins before and over the windows, and the speeds at the start.

    The speeds at the start are those of the wheels, where there are some, else of the inputs; [N, D].
    """
    rows = np.zeros((len(windows), 3 * (BINS + BINS_BEFORE + 1)))
    for place, run in enumerate(windows.drive):
        at = np.flatnonzero(windows.position == place)
        if len(at):
            rows[at] = _rows(run, windows.start[at], windows.end[at], windows.unknown_after)
    return rows


def _rows(run: PreparedRun, start: Floats, end: Floats, unknown_after: float) -> Floats:
    within = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, BINS + 1)
    before = start[:, None] + np.linspace(-SECONDS_BEFORE, 0.0, BINS_BEFORE + 1)
    columns = []
    for values in (run.inputs.v, run.inputs.vy, run.inputs.omega):
        held = HeldSum.of(run.inputs, values, unknown_after)
        for edges in (before, within):
            columns += [held.between(a, b) / (b - a) for a, b in zip(edges.T[:-1], edges.T[1:], strict=True)]
    speeds = run.inputs if run.wheels is None or len(run.wheels) == 0 else run.wheels
    last = np.clip(np.searchsorted(speeds.t, start, side="right") - 1, 0, None)
    return np.column_stack((*columns, speeds.v[last], speeds.vy[last], speeds.omega[last]))


def unwrapped_motion(windows: WindowSet) -> Floats:
    """Return what was measured, [N, 3]; the heading is followed along the poses beyond half a turn."""
    turned = np.zeros(len(windows))
    for place, run in enumerate(windows.drive):
        at = np.flatnonzero(windows.position == place)
        poses = run.run.poses
        yaw = np.unwrap(poses.yaw)
        turned[at] = np.interp(windows.end[at], poses.t, yaw) - np.interp(windows.start[at], poses.t, yaw)
    return beside(windows.measured, turned)


def beside(poses: Floats, heading: Floats) -> Floats:
    """Return poses [N, 3] with headings moved by whole turns, to be nearest to `heading` [N] rad."""
    whole = np.round((heading - poses[:, 2]) / (2.0 * np.pi))
    return np.column_stack((poses[:, :2], poses[:, 2] + 2.0 * np.pi * whole))


def chords(poses: Floats) -> Floats:
    """Return poses [N, 3] seen from half their heading: an arc has its chord along x, however it turns."""
    return np.column_stack((_turned(poses, -0.5), poses[:, 2]))


def poses_of(chord: Floats) -> Floats:
    """Return the poses [N, 3] that have these chords."""
    return np.column_stack((_turned(chord, 0.5), chord[:, 2]))


def _turned(poses: Floats, fraction: float) -> Floats:
    """Turn x and y by a fraction of the heading."""
    c, s = np.cos(fraction * poses[:, 2]), np.sin(fraction * poses[:, 2])
    return np.column_stack((c * poses[:, 0] - s * poses[:, 1], s * poses[:, 0] + c * poses[:, 1]))
