# SPDX-License-Identifier: Apache-2.0
"""The axes of a model's commands: how many numbers a command has, and in which order they stand."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.errors import ModelError, SettingsError
from slipwise.models.model import Model

Floats = NDArray[np.float64]

LEAST_SIDEWAYS = 0.05  # of the largest speed; less to the side is noise of odometry, and no axis of commands


@dataclass(frozen=True)
class Axes:
    """The numbers of a command, in the order of rows, columns, messages and the C header."""

    names: tuple[str, ...]
    units: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.names)

    @property
    def words(self) -> str:
        """Such as `(v [m/s], omega [rad/s])`."""
        return f"({', '.join(f'{n} [{u}]' if u else n for n, u in zip(self.names, self.units, strict=True))})"

    @property
    def sideways(self) -> bool:
        """Whether a speed to the left is among them."""
        return "vy" in self.names

    def check(self, what: str, numbers: int) -> None:
        """Refuse rows of another number of numbers: none is dropped and none made up.

        Raises:
            SettingsError: it is another one.
        """
        if numbers != len(self):
            raise SettingsError(
                f"{what} with {numbers} numbers each, and this model takes {len(self)}",
                advice=f"give {self.words}",
            )

    def twists(self, rows: Floats) -> Floats:
        """Rows [..., axes] as the core's (v, vy, omega), [..., 3]; throttle and steering are v and omega."""
        if rows.shape[-1] == 3:
            return rows
        return np.stack((rows[..., 0], np.zeros(rows.shape[:-1]), rows[..., 1]), axis=-1)

    def ahead(self, rows: ArrayLike) -> Floats:
        """Commands (v, omega) [..., 2] in these axes: without a sideways speed where there is one."""
        given = np.asarray(rows, dtype=np.float64)
        return np.insert(given, 1, 0.0, axis=-1) if self.sideways else given

    def of_twist(self, twist: Iterable[float]) -> tuple[float, ...]:
        """Return the command of the core's (v, vy, omega)."""
        v, vy, omega = (float(value) for value in twist)
        return (v, vy, omega) if self.sideways else (v, omega)


TWIST = Axes(("v", "omega"), ("m/s", "rad/s"))
SIDEWAYS = Axes(("v", "vy", "omega"), ("m/s", "m/s", "rad/s"))
THROTTLE = Axes(("throttle", "steering"), ("", ""))


def axes_of(model: Model) -> Axes:
    """Return the axes of the commands that a model takes."""
    if model.car is not None:
        return THROTTLE
    return drive_axes(model)


def drive_axes(model: Model) -> Axes:
    """Return the axes of what the drive of a model does, as wheels show it."""
    if model.car is not None:
        return TWIST
    driven = model.motion.basis.sideways or model.content.range.sideways is not None
    return SIDEWAYS if driven else TWIST


def sideways_span(v: NDArray[Any], vy: NDArray[Any]) -> list[float] | None:
    """Return the range of sideways speeds that inputs drove [m/s], None where they did not."""
    fastest = float(np.hypot(v, vy).max(initial=0.0))
    return driven_span(fastest, float(vy.min(initial=0.0)), float(vy.max(initial=0.0)))


def driven_span(fastest: float, right: float, left: float) -> list[float] | None:
    """Return sideways speeds, right <= 0 <= left, where they are an axis beside the fastest speed [m/s]."""
    return [right, left] if max(left, -right) > LEAST_SIDEWAYS * fastest else None


def refuse_sideways(model: Model, what: str) -> None:
    """Refuse a use that commands no sideways speed where the slip of the model depends on it.

    Raises:
        ModelError: it does.
    """
    if model.motion.basis.sideways:
        raise ModelError(
            f"{what} have no sideways speed, and the slip of this model depends on it",
            advice="predict, rollout, sample_futures, Controller and the C header take "
            f"{SIDEWAYS.words}; or calibrate with --basis full-linear-6",
        )
