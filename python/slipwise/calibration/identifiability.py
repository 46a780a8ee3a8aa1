# SPDX-License-Identifier: Apache-2.0
"""What a drive does not determine, what it cannot tell apart, and the driving that would."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from slipwise import _core
from slipwise.calibration.learner import Posterior
from slipwise.models.body_lag import is_body_lag, is_hidden_lag
from slipwise.models.parameter_table import physical_name
from slipwise.models.schema import UNIDENTIFIABLE_RATIO

#: Terms by which slip follows gravity at 1 m/s, the angle they come of and the direction it is in.
_BY_GRAVITY = {
    ("lon.gx", "lon.abs(V)*gx"): "ahead (pitch or force_x)",
    ("lat.gy", "lat.abs(V)*gy"): "to its side (roll or force_y)",
}
_LEAST_UPHILL, _SURE_UPHILL = 0.005, 5.0  # m/s per m/s2, and standard deviations of it
LOOK_ALIKE = 0.9  # correlation from which on two parameters count as confounded parameters


@dataclass(frozen=True)
class Confounded:
    """Two parameters that the drive can hardly tell apart: together they are known better than each."""

    first: str
    second: str
    correlation: float

    def __str__(self) -> str:
        return f"{physical_name(self.first)} and {physical_name(self.second)} ({self.correlation:+.2f})"


def not_identifiable(posterior: Posterior) -> tuple[str, ...]:
    """Return the parameters that the drive determines little better than the prior.

    Of a body that hardly lags behind its wheels no drive tells how little, and nobody needs it.
    """
    ratios = posterior.variance_ratio.tolist()
    return tuple(
        info.name
        for info, ratio in zip(posterior.motion.parameters, ratios, strict=True)
        if ratio > UNIDENTIFIABLE_RATIO and not (posterior.motion.lags and is_body_lag(info.name))
    )


def confounded(posterior: Posterior) -> tuple[Confounded, ...]:
    """Return the pairs that the drive can hardly tell apart, the closest first."""
    names = [info.name for info in posterior.motion.parameters]
    stds = np.sqrt(np.diag(posterior.covariance))
    hidden = {
        i
        for i, name in enumerate(names)
        if posterior.motion.lags and is_hidden_lag(name, posterior.mean[i], stds[i])
    }
    pairs = _core.correlated_pairs(posterior.covariance, LOOK_ALIKE)
    return tuple(
        Confounded(names[p.first], names[p.second], float(p.correlation))
        for p in pairs
        if not hidden & {p.first, p.second}
    )


def longest_delay(names: Sequence[str], values: Sequence[float]) -> float:
    """Return the longest time from an input to its first effect [s], by the model's own parameters."""
    found = dict(zip(names, values, strict=True))
    plain = [found[name] for name in ("delay_v", "delay_omega") if name in found]
    logs = [math.exp(found[name]) for name in ("log_delay_v", "log_delay_omega") if name in found]
    return max([*plain, *logs, 0.0])


def drives_for(names: tuple[str, ...], *, positions: bool = False) -> tuple[str, ...]:
    """Say which driving would determine the parameters, in words.

    Args:
        names: of the parameters.
        positions: only positions are measured, which do not see a side slip on straight ways.
    """
    if positions:
        names = tuple(name for name in names if not (name.startswith("lat.") and not _turns(name)))
    advice = []
    for matches, sentence in _DRIVES:
        found = [name for name in names if matches(name)]
        if found:
            advice.append(f"{sentence} (for {', '.join(map(physical_name, found))}).")
    return tuple(advice)


def advice_for_pairs(pairs: tuple[Confounded, ...]) -> tuple[str, ...]:
    """Say what would tell confounded parameters apart, where that is known, in words."""
    advice = []
    for matches, sentence in _APART:
        found = [str(pair) for pair in pairs if matches(pair) or matches(_swapped(pair))]
        if found:
            advice.append(f"{sentence}: {', '.join(found)}.")
    return tuple(advice)


def timing_words(
    motion: _core.MotionModel, unknown: tuple[str, ...], *, wheels_logged: bool, wheels_advice: str = ""
) -> str:
    """Say which delay is which, and which offset of clocks it holds; empty where no time is learned.

    `wheels_advice` says how wheel speeds of the log could be read, where they are not.
    """
    sentences = []
    if motion.dynamics and motion.clock_offset:
        sentences.append(
            "Delays are from commands to wheel speeds, any offset between their clocks included."
        )
    elif motion.dynamics or motion.delays:
        sentences.append(
            "Delays are from commands to poses, any offset between their clocks included: this log cannot "
            "separate the two."
        )
        if not wheels_logged:
            how = f"; {wheels_advice}" if wheels_advice else ""
            sentences.append(f"Wheel speeds in the log would{how}.")
    if motion.clock_offset:
        held = "" if motion.dynamics else ", less half of their period, as they are held until the next"
        lag = ", beside the lag of the body" if motion.lags else ""
        from_sampling = "One within half" if motion.dynamics else "A negative one below"
        sentences.append(
            f"clock_offset is how much later poses come than wheel speeds{held}{lag}: they are stamped late, "
            f"or the robot follows its wheels late. {from_sampling} the period of the wheel speeds comes "
            "from their sampling."
        )
        if "clock_offset" in unknown:
            sentences.append("This drive does not determine it.")
    return " ".join(sentences)


def _terms(name: str) -> str:
    return name.partition(".")[2]


def _slopes(name: str) -> bool:
    return "gx" in _terms(name) or "gy" in _terms(name)


def _turns(name: str) -> bool:
    return ("w" in _terms(name) or "kappa" in _terms(name)) and not _slopes(name) and not _headed(name)


def _headed(name: str) -> bool:
    return "yaw" in _terms(name)


def _swapped(pair: Confounded) -> Confounded:
    return Confounded(pair.second, pair.first, pair.correlation)


def _same_channel(pair: Confounded) -> bool:
    return pair.first.rpartition("_")[2] == pair.second.rpartition("_")[2]


_DRIVES: tuple[tuple[Callable[[str], bool], str], ...] = (
    (
        lambda n: n in ("log_time_constant_v", "log_delay_v", "delay_v", "gain_v"),
        "Change the speed in steps, from rest and back, several times",
    ),
    (
        lambda n: n in ("log_time_constant_omega", "log_delay_omega", "delay_omega", "gain_omega"),
        "Change the yaw rate in steps, to both sides, several times",
    ),
    (
        lambda n: n.startswith(("slow_fraction", "log_slow_time_constant")),
        "After a step of the command, hold it for several seconds",
    ),
    (
        lambda n: n == "clock_offset",
        "Accelerate, brake and swing in and out of turns; steady driving cannot show a clock offset",
    ),
    (
        lambda n: n in ("sensor_x", "sensor_y"),
        "Turn on the spot both ways, or drive tight arcs; straight driving cannot show a lever arm",
    ),
    (
        lambda n: n == "sensor_yaw",
        "Drive straight for longer; turning on the spot cannot show how a sensor is turned",
    ),
    (
        _headed,
        "Drive in several directions over the map, forwards and backwards",
    ),
    (
        _slopes,
        "Drive up, down and across a slope, with roll and pitch in the log, or under a known force",
    ),
    (lambda n: _turns(n) and "V" in _terms(n), "Drive arcs of both hands at several speeds"),
    (lambda n: _turns(n) and "V" not in _terms(n), "Turn both ways at several yaw rates, in place too"),
    (
        lambda n: "V" in _terms(n) and not _turns(n) and "g" not in _terms(n) and not _headed(n),
        "Drive straight at several speeds, forwards and backwards",
    ),
)

_APART: tuple[tuple[Callable[[Confounded], bool], str], ...] = (
    (
        lambda p: p.first.startswith("sensor_") and "." in p.second,
        "A sensor away from base_link looks like slip: give its place under [sensor_extrinsics]",
    ),
    (
        lambda p: (
            p.first.startswith("log_time_constant") and p.second.startswith("log_delay") and _same_channel(p)
        ),
        "Lag and delay are hard to separate; record poses more often, and change commands in steps",
    ),
)


def uphill(posterior: Posterior) -> tuple[str, ...]:
    """Return the directions in which slip goes against gravity at 1 m/s, which no robot's does."""
    names = [info.name for info in posterior.motion.parameters]
    found = []
    for terms, said in _BY_GRAVITY.items():
        row = np.isin(names, terms).astype(np.float64)
        slip, std = float(row @ posterior.mean), float(np.sqrt(row @ posterior.covariance @ row))
        if slip < -max(_LEAST_UPHILL, _SURE_UPHILL * std):
            found.append(said)
    return tuple(found)
