# SPDX-License-Identifier: Apache-2.0
"""Keys of settings that users had before, each with what holds now; read for one release, with a note."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

#: Keys that stand elsewhere now, or that another key says.
MOVED = {
    "vehicle.wheel_separation": "log.wheel_separation",
    "live.host": "live.address",
}

_OPTION = "an option of the command line alone, where slipwise convert takes it for logs of a fleet: "
_OF_VEHICLE = "a key of the file of log.vehicle, or "
_ARRIVES = "gone: it follows from what arrives"
_CONSTANT = "a constant of slipwise"

#: What holds now in place of each key. A constant that the tables still have is read for this release.
GONE = {
    **{f"log.{name}": _OPTION + f"--{name.replace('_', '-')}" for name in (
        "poses", "pose_clock_offset", "start", "end",
    )},
    "log.pose_yaw_offset": "sensor_extrinsics.yaw with the other sign, or --pose-yaw-offset, which turns "
    "roll and pitch too",
    **{f"log.{name}": _OF_VEHICLE + f"--{name.replace('_', '-')}" for name in (
        "left_joints", "right_joints", "wheelbase", "wheel_scale",
    )},
    "log.most_unpacked": "gone: unpack a larger file first",
    "log.most_fetched": "gone: copy a larger file first",
    **{f"live.{name}": f"an option of the command line alone: --{name}" for name in (
        "name", "transport", "input", "model", "memory", "cache", "surface",
    )},
    "live.domain": "gone: set ROS_DOMAIN_ID",
    "live.duration": "gone: end the node by `timeout -s INT SECONDS slipwise live ...`",
    "live.gyro_alone": _ARRIVES,
    "live.sources": _ARRIVES,
    "live.attitude": _ARRIVES,
    "live.sideways": _ARRIVES + ", and from log.vehicle",
    "live.save_every": "gone: the cache is written every 60 s",
    "live.moves_every": "gone: moves are looked for every 10 s",
    "live.gates.stale_after": "gone: inputs are stale after 1 s",
    "live.gates.reverse": "gone: it follows from the start model",
    "live.apply.ros_distro": "gone: set ROS_DISTRO",
    "live.apply.update_rate": "gone: slipwise export --update-rate writes the covariance of the twist",
    "live.apply.planning_horizon": "gone: 2.8 s, as Nav2 plans by default",
    "live.apply.threshold": "gone: 0.02 prior standard deviations",
    "live.apply.within": "gone: 1 prior standard deviation beyond what is certain",
    "live.apply.rate": "gone: 0.01 prior standard deviations a second",
    "learn_clock_offset": _CONSTANT,
    **{f"prior.{name}": _CONSTANT for name in ("clock_offset_std", "time_constant", "delay")},
    **{f"noise.{name}": _CONSTANT for name in (
        "psd_time", "psd_motion", "pose_std_xy", "pose_std_yaw", "adapt",
    )},
    "filter.huber": _CONSTANT,
    "auto.bases": "gone: name one with basis",
    "auto.structures": "gone: slipwise keeps the one that predicts best",
    "slip_disturbance.learn": _CONSTANT,
    "body_force.time_constant": _CONSTANT,
    "body_force.std": _CONSTANT,
    "change.detect": "gone: slip that jumps is followed at any time",
    "change.branches": _CONSTANT,
    "smoothing.drift": _CONSTANT,
    "smoothing.length": _CONSTANT,
}  # fmt: skip


def notes_of_gone(content: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield each key of a settings file that users no longer have, with what holds now."""
    for path, now in GONE.items():
        if _has(content, path):
            yield path, f"{path} is {now}"


def moved(content: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return the content with moved keys at their places, and what moved; a present key goes before it."""
    result, said = dict(content), []
    for old, new in MOVED.items():
        if _has(result, old):
            value = _taken(result, old)
            said.append(f"{old} is {new} now")
            if not _has(result, new):
                _put(result, new, value)
    return result, said


def without(content: Mapping[str, Any], paths: Iterable[str]) -> dict[str, Any]:
    """Return the content without some keys."""
    result = dict(content)
    for path in paths:
        if _has(result, path):
            _taken(result, path)
    return result


def _has(content: Mapping[str, Any], path: str) -> bool:
    *tables, name = path.split(".")
    inner: Any = content
    for table in tables:
        inner = inner.get(table) if isinstance(inner, Mapping) else None
    return isinstance(inner, Mapping) and name in inner


def _taken(content: dict[str, Any], path: str) -> Any:
    """Take a key out of nested tables, and a table that is empty then."""
    table, _, rest = path.partition(".")
    if not rest:
        return content.pop(table)
    inner = dict(content[table])
    value = _taken(inner, rest)
    if inner:
        content[table] = inner
    else:
        del content[table]
    return value


def _put(content: dict[str, Any], path: str, value: Any) -> None:
    table, _, rest = path.partition(".")
    if not rest:
        content[table] = value
        return
    inner = dict(content.get(table, {}))
    _put(inner, rest, value)
    content[table] = inner
