# SPDX-License-Identifier: Apache-2.0
"""Where a pose sensor would sit whose place looks like the slip of a model (derivations/sensors.md)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from slipwise.models.body_gains import BodyTwists, body_twists
from slipwise.models.model import Model
from slipwise.models.mounted import given_place
from slipwise.models.parameter_table import IDENTIFIED_FRACTION
from slipwise.number_text import estimate_text, estimate_texts

_FAR = 0.05  # [m] nearer to the centre of turning, a sensor hardly matters
_TURNED = 0.05  # [rad] the same of its heading
_SIGNIFICANT = 3.0  # standard deviations
_APART = 0.1  # least singular value over the largest: below it, speeds and turns came together
_TERMS = ("lat.w", "lon.w", "lat.V")  # that x, y and yaw look like
_PLACES = ((0, "ahead of", "behind"), (1, "left of", "right of"))


@dataclass(frozen=True)
class SensorLook:
    """The pose of a sensor in the frame of the robot whose centre of turning is its origin; NaN: unknown."""

    pose: tuple[float, float, float]  # m ahead, m to the left, rad to the left
    std: tuple[float, float, float]

    def clear(self, axis: int) -> bool:
        """Whether an axis (0 x, 1 y, 2 yaw) is known well, and not about zero."""
        size, std = abs(self.pose[axis]), self.std[axis]
        least = _TURNED if axis == 2 else _FAR
        return size > least and size > _SIGNIFICANT * std and std <= IDENTIFIED_FRACTION * size


def sensor_look(model: Model) -> SensorLook:
    """Return the place of a sensor, on a robot that turns about its origin, that would look like the slip.

    A robot that drives v and turns w moves such a sensor at R(-yaw) (v - w y, w x). The slip is taken as
    straight lines through v and w over the range of the log; what is not straight in it counts as an error
    of both. Nothing is known where speeds and turns came together, as on a circle.
    """
    body = body_twists(model)
    yaw_gain = body.line(2, body.w)[0][0]
    ahead, left = (body.line(axis, body.v, body.w) for axis in (0, 1))  # [v, w]
    if not (yaw_gain > 0.0 and ahead[0][0] > 0.0 and _told_apart(body)):
        return SensorLook((math.nan,) * 3, (math.nan,) * 3)
    bent = [_bent(body, axis, line[0]) for axis, line in ((0, ahead), (1, left))]  # m/s
    covariance = model.covariance[: model.motion.slip_size, : model.motion.slip_size]
    gains = np.array([ahead[0], left[0]])  # [2 axes, (v, w)]
    by_slip = np.array([ahead[1], left[1]])  # [2, 2, slip parameters]
    yaw = -math.atan2(gains[1, 0], gains[0, 0])
    by_v, by_w = (1.0 / max(_size(each), 1e-9) for each in (body.v, body.w))
    yaw_std = math.hypot(_std(by_slip[1, 0], covariance), bent[1] * by_v) / gains[0, 0]
    clear = abs(yaw) > max(_TURNED, _SIGNIFICANT * yaw_std)
    turn = yaw if clear else 0.0
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    arm = rotation @ gains[:, 1] / yaw_gain  # (-y, x)
    by_arm = rotation @ by_slip[:, 1] / yaw_gain
    return SensorLook(
        (float(arm[1]), float(-arm[0]), yaw),
        (
            math.hypot(_std(by_arm[1], covariance), bent[1] * by_w / yaw_gain),
            math.hypot(_std(by_arm[0], covariance), bent[0] * by_w / yaw_gain),
            yaw_std,
        ),
    )


def sensor_sentences(model: Model) -> list[str]:
    """Say where a sensor would sit that looks like the slip, and which settings say so."""
    if model.motion.slip_size == 0 or model.motion.sensor_extrinsics:
        return []
    look = sensor_look(model)
    seen = [axis for axis in range(3) if look.clear(axis)]
    if not seen:
        return []
    said = [
        f"{estimate_text(abs(look.pose[axis]), look.std[axis])} m {plus if look.pose[axis] > 0.0 else minus}"
        for axis, plus, minus in _PLACES
        if axis in seen
    ]
    place = f"{' and '.join(said)} the centre of turning" if said else ""
    if 2 in seen:
        side = "left" if look.pose[2] > 0.0 else "right"
        degrees = estimate_text(math.degrees(abs(look.pose[2])), math.degrees(look.std[2]))
        place += f"{', ' if place else ''}turned by {degrees} deg to the {side}"
    numbers = " ".join(_setting(model, look, axis) for axis in seen)
    terms = ", ".join(_TERMS[axis] for axis in seen)
    look_like = f"The learned slip ({terms}) looks like a pose sensor {place}"
    there = f"if it sits there, add {numbers}"
    return [f"{look_like}: {there}; `export --to mounts --no-side-slip` writes it"]


@dataclass(frozen=True, eq=False)
class IfTurned:
    """What a model would have learned, were its side slip the heading of a sensor that is turned."""

    change: np.ndarray  # [slip parameters] of their values
    words: str  # by how much it is turned, and the setting that says so


def if_turned(model: Model) -> IfTurned | None:
    """Return what a turned sensor would change; None where nothing looks like one."""
    if model.motion.slip_size == 0 or model.motion.sensor_extrinsics:
        return None
    look = sensor_look(model)
    if not look.clear(2):
        return None
    body, change = body_twists(model), np.zeros(model.motion.slip_size)
    cos, sin = math.cos(look.pose[2]), math.sin(look.pose[2])
    turned = np.array([[cos, -sin], [sin, cos]]) @ body.mean[:, :2].T
    for axis, moved in enumerate(turned):
        change += np.linalg.pinv(body.features[:, axis]) @ (moved - body.mean[:, axis])
    degrees = " +- ".join(estimate_texts(math.degrees(abs(look.pose[2])), math.degrees(look.std[2])))
    return IfTurned(change, f"turned by {degrees} deg, as {_setting(model, look, 2)} says")


def _setting(model: Model, look: SensorLook, axis: int) -> str:
    name = ("x", "y", "yaw")[axis]
    return f"--set sensor_extrinsics.{name}={given_place(model)[axis] + look.pose[axis]:.2f}"


def _told_apart(body: BodyTwists) -> bool:
    """Whether the log has turns without the speed that goes with them, and the other way."""
    sizes = np.array([_size(body.v), _size(body.w)])
    if not (sizes > 0.0).all():
        return True  # it has one of them alone, and the line through the other is 0
    least = np.linalg.svd(np.column_stack((body.v, body.w)) / sizes, compute_uv=False)
    return bool(least[1] > _APART * least[0])


def _bent(body: BodyTwists, axis: int, line: np.ndarray) -> float:
    """Return what a straight line through v and w leaves [m/s]."""
    return _size(body.mean[:, axis] - np.column_stack((body.v, body.w)) @ line)


def _size(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _std(derivative: np.ndarray, covariance: np.ndarray) -> float:
    return float(np.sqrt(max(derivative @ covariance @ derivative, 0.0)))
