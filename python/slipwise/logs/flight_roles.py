# SPDX-License-Identifier: Apache-2.0
"""Messages of an autopilot as columns, and what turns them into streams east-north-up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from slipwise.logs.kinematics import twist_from_wheels
from slipwise.logs.log import Floats
from slipwise.logs.navsat import angles_at

Columns = Mapping[str, Floats]


@dataclass(frozen=True)
class FlightMessages:
    """What was read: for each kind of message its fields, and "t" in s since the vehicle started."""

    kind: str
    topics: Mapping[str, Columns]
    parameters: Mapping[str, float]


@dataclass(frozen=True)
class FlightStream:
    """One stream of the log, before anything is left out."""

    topic: str
    t: Floats  # [N] s
    columns: Columns  # [N] each


@dataclass
class FlightStreams:
    """What the messages are used as, and sentences about what was guessed."""

    commands: FlightStream | None = None
    wheels: FlightStream | None = None
    poses: FlightStream | None = None
    notes: list[str] = field(default_factory=list)


def held(t: Floats, other_t: Floats, values: Floats) -> Floats:
    """Return at each time [N] the last of the values [M] until then, NaN before the first."""
    if len(other_t) == 0:
        return np.full(len(t), np.nan)
    index = np.searchsorted(other_t, t, side="right") - 1
    return np.where(index >= 0, values[np.clip(index, 0, None)], np.nan)


def between(t: Floats, other_t: Floats, angles: Floats) -> Floats:
    """Return angles [M] in rad at times [N], interpolated; NaN where none is near enough."""
    finite = np.isfinite(angles) & np.isfinite(other_t)
    found, near = angles_at(t, other_t[finite], angles[finite])
    return np.where(near, found, np.nan)


def yaw_from_heading(heading: Floats) -> Floats:
    """Return the yaw from east, counter-clockwise, of a heading from north, clockwise [rad]."""
    yaw = np.pi / 2.0 - heading
    return np.arctan2(np.sin(yaw), np.cos(yaw))


def wheels_from_distances(
    topic: str, t: Floats, left: Floats, right: Floats, separation: float
) -> FlightStream | None:
    """Return the wheels' twist, until the next stamp, from the distances [N] in m that they travelled.

    Between a stamp and one that is not later there is no twist.
    """
    order = np.concatenate([[True], np.diff(t) > 0.0])
    t, left, right = t[order], left[order], right[order]
    steps = np.diff(t)
    later = steps > 0.0
    if not later.any():
        return None
    left_speed, right_speed = np.diff(left)[later] / steps[later], np.diff(right)[later] / steps[later]
    v, omega = twist_from_wheels(left_speed, right_speed, wheel_radius=1.0, wheel_separation=separation)
    return FlightStream(topic, t[:-1][later], {"v": v, "omega": omega})
