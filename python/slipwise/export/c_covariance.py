# SPDX-License-Identifier: Apache-2.0
"""The parts of the C header that say how sure a prediction is: covariance, slip noise and Student t."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.models.axes import axes_of
from slipwise.models.model import Model
from slipwise.prediction import student_at

_SHIFTED = {
    "log_time_constant_v": "model.speed.time_constant *= SLIPWISE_MATH(exp)({by})",
    "log_time_constant_omega": "model.yaw.time_constant *= SLIPWISE_MATH(exp)({by})",
    "log_delay_v": "model.delay_v *= SLIPWISE_MATH(exp)({by})",
    "log_delay_omega": "model.delay_omega *= SLIPWISE_MATH(exp)({by})",
    "delay_v": "model.delay_v += {by}",
    "delay_omega": "model.delay_omega += {by}",
    "gain_v": "model.speed.gain += {by}",
    "gain_omega": "model.yaw.gain += {by}",
    "slow_fraction_v": "model.speed.slow_fraction += {by}",
    "slow_fraction_omega": "model.yaw.slow_fraction += {by}",
    "log_slow_time_constant_v": "model.speed.slow_time_constant *= SLIPWISE_MATH(exp)({by})",
    "log_slow_time_constant_omega": "model.yaw.slow_time_constant *= SLIPWISE_MATH(exp)({by})",
}


def shifts(model: Model) -> str:
    """Return the lines that add `by` to the parameters.

    Raises:
        ModelError: the actuator model has a parameter that is not known.
    """
    lines = []
    for i, parameter in enumerate(model.vector.rows):
        if i < model.motion.slip_size:
            lines.append(f"    model.p[{i}] += by[{i}];")
        elif parameter.name in _SHIFTED:
            lines.append(f"    {_SHIFTED[parameter.name].format(by=f'by[{i}]')};")
        else:
            raise ModelError(f"the actuator model has {parameter.name}, which cannot be exported")
    return "\n".join(lines)


def noise(model: Model) -> str:
    """Return the slip noise as constants, and how it grows along a path."""
    learned, sideways = model.noise, axes_of(model).sideways
    scalars = {
        "TURN_RADIUS": (_core.TURN_RADIUS, "[m] a turn of 1 rad slips like driving so far"),
        "STRAIGHT_RADIUS": (
            _core.STRAIGHT_RADIUS,
            "[m] driving turns it as an arc of this radius",
        ),
        "POSE_STD_XY": (learned.pose_std_xy, "[m] of a measured pose"),
        "POSE_STD_YAW": (learned.pose_std_yaw, "[rad]"),
    }
    root = np.sqrt(np.array(model.content.noise.variance_scale)).tolist()
    lines = [
        f"#define SLIPWISE_{name} SLIPWISE_R({value!r})  /* {what} */"
        for name, (value, what) in scalars.items()
    ]
    lines.append("/* Learned factors of the noise's standard deviations in x, y and yaw. */")
    lines.append(f"static const slipwise_real slipwise_noise_root[3] = {{{_numbers(root)}}};")
    return _filled(
        "noise_template.h",
        {
            "NOISE_TIME": _numbers(learned.psd_time),
            "NOISE_MOTION": _numbers(learned.psd_motion),
            "NOISE_FRACTION": _numbers(learned.fraction),
            "NOISE_SCALARS": "\n".join(lines),
            "DISTANCE": "SLIPWISE_MATH(hypot)(mean.v, mean.vy)"
            if sideways
            else "SLIPWISE_MATH(fabs)(mean.v)",
        },
    )


def covariance(model: Model) -> str:
    """Return the roots of the parameters' covariance, the slip disturbance, the Student t, and their code."""
    rows = _roots(model)
    seconds = sorted(model.content.noise.student_t) or [0.0]
    at = [(s, student_at(model, s)) for s in seconds]
    students = [(s, math.log(tail.inflation), math.log(tail.dof)) for s, tail in at]
    disturbance = _disturbed(model)
    return _filled(
        "covariance_template.h",
        {
            "ROOT_COUNT": str(len(rows)),
            "ROOTS": _rows(rows),
            "DISTURBED_COUNT": str(len(disturbance.places)),
            "DISTURBED": ", ".join(map(str, disturbance.places)) or "0",
            "TIME_COUNT": str(len(disturbance.times)),
            "TIMES": _numbers(disturbance.times) or _numbers([0.0]),
            "VARIANCES": _rows(disturbance.variances.T.tolist()),
            "TAIL_COUNT": str(len(students)),
            "TAILS": ", ".join(f"{{{_numbers(row)}}}" for row in students),
        },
    )


@dataclass(frozen=True, eq=False)
class _Disturbed:
    """Slip parameters that are disturbed, and how far by each time constant."""

    places: list[int]
    times: list[float]  # s
    variances: NDArray[np.float64]  # [times, places]


def _disturbed(model: Model) -> _Disturbed:
    terms = _core.disturbed_terms(model.motion, model.prior_std)
    law = model.disturbance
    times = sorted({disturbance.time_constant for disturbance in law.candidates})
    variances = np.zeros((len(times), len(terms.places)))
    for disturbance, weight in zip(law.candidates, law.weights, strict=True):
        variances[times.index(disturbance.time_constant)] += weight * terms.variances(disturbance)
    disturbed, lasts = variances.any(axis=0), variances.any(axis=1)
    return _Disturbed(
        np.array(terms.places, dtype=np.int64)[disturbed].tolist(),
        np.array(times)[lasts].tolist(),
        variances[np.ix_(lasts, disturbed)],
    )


def _roots(model: Model) -> list[list[float]]:
    """Return rows whose squares add up to the covariance; those of parameters without any are left out."""
    if not model.mean.size:
        return []
    values, vectors = np.linalg.eigh(model.covariance)
    rows = (vectors * np.sqrt(values.clip(0.0))).T
    return [row for row in rows.tolist() if any(row)]


def _rows(rows: Sequence[Iterable[float]]) -> str:
    """Return the rows of an array in C; none become one that is not used."""
    return ",\n".join(f"    {{{_numbers(row)}}}" for row in rows) or "    {SLIPWISE_R(0)}"


def _numbers(values: Iterable[float]) -> str:
    return ", ".join(f"SLIPWISE_R({float(value)!r})" for value in values)


def _filled(name: str, parts: dict[str, str]) -> str:
    text = files("slipwise.export").joinpath(name).read_text(encoding="utf-8").rstrip("\n")
    for place, value in parts.items():
        text = text.replace(f"@{place}@", value)
    return text
