# SPDX-License-Identifier: Apache-2.0
"""What was learned of several sources of poses, in numbers and in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.fixes import FIXES
from slipwise.models.mounted import KNOWN
from slipwise.number_text import estimate_text

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LearnedSource:
    """Estimates of a pose source; the first's lateness and place are parameters of the model."""

    name: str
    late: float  # s by which its stamps are late, beside those of the inputs
    late_std: float  # s
    sensor: Floats  # [3] x, y [m], yaw [rad] in base_link
    sensor_std: Floats  # [3]
    noise: dict[
        str, Floats
    ]  # by fix, "" where none is said: [3] errors (x, y, theta) over those of the first
    segments: int  # learned between its poses

    def sentence(self, *, placed: bool = False) -> str:
        """Say it in words; its place and clock are `placed` where both sources together told them better."""
        said = [f"{self.segments} segments are those of {self.name or 'the first source'}"]
        if 0.0 < self.late_std <= KNOWN and not placed:
            said.append(f"stamped {self.late:+.3f} s late (± {self.late_std:.3f} s)")
        if self.sensor_std.any() and np.all(self.sensor_std <= KNOWN) and not placed:
            x, y, yaw = map(estimate_text, self.sensor.tolist(), self.sensor_std.tolist())
            said.append(f"sitting at x {x} m, y {y} m, yaw {yaw} rad")
        sizes = [
            f"{np.exp(np.log(ratio).mean()):.2g} times as large{f' of {fix}' if fix else ''}"
            for fix, ratio in self.noise.items()
        ]
        if sizes and any(np.any(ratio != 1.0) for ratio in self.noise.values()):
            said.append(f"errors {', '.join(sizes)}")
        return "; ".join(said)


def learned_sources(learner: _core.MotionLearner, names: Sequence[str]) -> tuple[LearnedSource, ...]:
    """Return what a learner knows of its sources, by these names; an empty tuple if it has one source."""
    found = []
    for i, (name, source) in enumerate(zip(names, learner.sources, strict=bool(names))):
        late_std, *sensor_std = np.sqrt(np.diag(source.calibration.covariance)).tolist()
        late, *sensor = source.calibration.mean.tolist()
        noise = np.array(source.noise)
        found.append(
            LearnedSource(
                name,
                0.0 if i == 0 else late,
                0.0 if i == 0 else late_std,
                np.array(sensor),
                np.zeros(3) if i == 0 else np.array(sensor_std),
                {fix: noise[k] for k, fix in enumerate(FIXES) if source.seen[k]},
                source.segments,
            )
        )
    return tuple(found)
