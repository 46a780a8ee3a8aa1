# SPDX-License-Identifier: Apache-2.0
"""By how much the clock of poses is off that of inputs as time goes by, from the motion that both saw.

In windows of twenty seconds the speeds of poses and inputs are correlated, and apart from them their yaw
rates: a drive may answer one of them later than the other, always by as much.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.logs.log import Bools, Floats, Inputs, Poses
from slipwise.logs.pose_clock import Driven, PoseMotion, input_means, pose_motion

WINDOW, EVERY = 20.0, 10.0  # s
_STEP = 0.1  # s
_TRIED = np.arange(-3.0, 3.0 + 0.5 * _STEP, _STEP)  # s added to the poses
_LAG = 0.2  # s of a usual drive behind commands
_FEWEST = 15  # steps between poses in a window
_LOBE = 0.6  # s about the best offset that belong to its peak
_CLEAR = 8.0  # logarithm of how much likelier it is than any other
_KNOWN = 0.1  # s: standard deviation up to which an offset is one


@dataclass(frozen=True, eq=False)
class RunningOffset:
    """Offsets by one kind of motion; windows overlap by half, and those that tell none are left out."""

    t: Floats  # [W] s, the middle of each window on the clock of the poses
    offset: Floats  # [W] s to add to the stamps of the poses
    std: Floats  # [W] s, were errors of the motion not alike from one to the next

    def __len__(self) -> int:
        return len(self.t)


def running_offsets(
    inputs: Inputs, poses: Poses, unknown_after: float, *, lagging: bool
) -> tuple[RunningOffset, RunningOffset]:
    """Return offsets by speeds, and by yaw rates.

    Args:
        inputs: of a run.
        poses: of the same run.
        unknown_after: an input is unknown once it is older than this [s].
        lagging: the inputs are commands, which a drive follows with a lag; its delay stays in the offset.
    """
    heading = np.full(len(poses), np.nan) if poses.course else poses.yaw
    motion = pose_motion(poses.t, poses.x, poses.y, heading)
    drive = [Driven.of(inputs, _LAG if lagging else 0.0, unknown_after)]
    tried = [input_means(drive, motion.start + by, motion.stop + by) for by in _TRIED.tolist()]
    speeds, rates = (np.array(channel) for channel in zip(*tried, strict=True))
    return _offsets(motion, motion.speed, speeds), _offsets(motion, motion.rate, rates)


def _offsets(motion: PoseMotion, seen: Floats, driven: Floats) -> RunningOffset:
    """Return the offset of each window, from what poses [N] and inputs at each offset [L, N] say."""
    t = 0.5 * (motion.start + motion.stop)
    known = np.isfinite(seen) & np.isfinite(driven).all(axis=0)
    begins = np.arange(t[0], t[-1] - 0.5 * WINDOW, EVERY) if len(t) else np.empty(0)
    windows = ((t >= begin) & (t < begin + WINDOW) & known for begin in begins.tolist())
    found = [each for each in (_offset(t, seen, driven, at) for at in windows) if each is not None]
    return RunningOffset(*np.array(found).reshape(-1, 3).T)


def _offset(t: Floats, seen: Floats, driven: Floats, at: Bools) -> tuple[float, float, float] | None:
    """Return the middle, the offset and its standard deviation [s]; None where it is not clear."""
    count = int(at.sum())
    if count < _FEWEST:
        return None
    left = _left(seen[at], driven[:, at])
    best = int(np.argmin(left))
    if best in (0, len(left) - 1):
        return None
    before, least, after = left[best - 1 : best + 2].tolist()
    bend = (before - 2.0 * least + after) / _STEP**2
    other = float(left[np.abs(_TRIED - _TRIED[best]) > _LOBE].min())
    if bend <= 0.0 or 0.5 * count * np.log(other / least) < _CLEAR:
        return None
    std = float(np.sqrt(2.0 * least / (count * bend)))
    offset = float(_TRIED[best] + 0.5 * _STEP * (before - after) / (before - 2.0 * least + after))
    return (float(t[at].mean()), offset, std) if std < _KNOWN else None


def _left(seen: Floats, driven: Floats) -> Floats:
    """Return the part of the variance of what was seen [N] that inputs at each offset [L, N] leave, [L]."""
    a, b = seen - seen.mean(), driven - driven.mean(axis=1, keepdims=True)
    scale = np.sqrt((a @ a) * np.einsum("ln,ln->l", b, b))
    alike = np.where(scale > 0.0, b @ a / np.where(scale > 0.0, scale, 1.0), 0.0)
    return np.maximum(1.0 - np.maximum(alike, 0.0) ** 2, np.finfo(float).eps)
