# SPDX-License-Identifier: Apache-2.0
"""A C header with the model as constants and a prediction that needs nothing but <math.h>."""

from __future__ import annotations

import math
import re
from importlib.resources import files

from slipwise import _core
from slipwise.export.actuator import actuator_of
from slipwise.export.c_covariance import covariance, noise, shifts
from slipwise.export.origin import one_line
from slipwise.models.axes import axes_of
from slipwise.models.limits import KINDS
from slipwise.models.model import Model
from slipwise.models.parameter_table import physical_name, physical_parameters
from slipwise.number_text import estimate_texts

_TEMPLATE = "model_template.h"
_QUANTITIES = {
    "V": "v",
    "w": "w",
    "abs(V)": "abs_v",
    "abs(w)": "abs_w",
    "sgn(V)": "sgn_v",
    "kappa": "kappa",
    "gx": "gx",
    "gy": "gy",
    "Vy": "vy",
    "abs(Vy)": "abs_vy",
    "V3": "third",
}
_MADE = {
    "abs_v": "SLIPWISE_MATH(fabs)(v)",
    "abs_w": "SLIPWISE_MATH(fabs)(w)",
    "sgn_v": "SLIPWISE_R((v > 0) - (v < 0))",
    "kappa": "w * v / (v * v + SLIPWISE_R({regular}))",
    "abs_vy": "SLIPWISE_MATH(fabs)(vy)",
    "third": "vy * (3 * v * v - vy * vy) / (v * v + vy * vy + SLIPWISE_R({regular}))",
}
#: Parts of the templates that only the header of a robot that drives sideways, or of one that steers, has.
_SIDEWAYS = re.compile(r"@SIDE\{(.*?)\}@", re.DOTALL)
_STEERS = re.compile(r"@STEER\{(.*?)\}@", re.DOTALL)
_TURNS = re.compile(r"@TURNS\{(.*?)\}@", re.DOTALL)  # of one that does not steer
_PROBE = 2.0**-30  # m/s, far below the speed that regularises the curvature
_NONE = _core.AxisLimits()


def c_header(model: Model, origin: list[str]) -> str:
    """Return the header.

    Args:
        model: the model.
        origin: lines of the comment on top.

    Raises:
        ModelError: the actuator model has a part that is not known.
    """
    model = model.body
    template = files("slipwise.export").joinpath(_TEMPLATE).read_text(encoding="utf-8")
    inputs = "commanded speeds" if model.content.input == "command" else "wheel speeds"
    parts = {
        "ORIGIN": "\n".join(("/*", *(f" * {one_line(line)}" for line in origin), " */")),
        "INPUT": inputs,
        "CONSTANTS": _constants(model),
        "RANGE": _range(model),
        "LIBRARY": _library(model),
        "LIMITS": limits(model),
        "CURSOR": cursor(model),
        "SLIP": "\n".join(f"  {line}" for line in _slip(model)),
        "LEARNED": _learned(model),
        "SHIFTS": shifts(model),
        "NOISE": noise(model),
        "COVARIANCE": covariance(model),
        "STANDING": repr(_core.STANDING_SPEED),
        "SHOWS": repr(_core.SHOWS_CURVATURE),
        "TANGENT": repr(_core.SHARPEST_TANGENT),
    }
    for name, text in parts.items():
        template = template.replace(f"@{name}@", text)
    steers = bool(model.motion.wheelbase)
    template = _TURNS.sub("" if steers else r"\1", _STEERS.sub(r"\1" if steers else "", template))
    return _SIDEWAYS.sub(r"\1" if axes_of(model).sideways else "", template)


def _define(name: str, value: float, comment: str) -> str:
    return f"#define SLIPWISE_{name} SLIPWISE_R({value!r})  /* {one_line(comment)} */"


def _constants(model: Model) -> str:
    actuator, wheelbase = actuator_of(model), model.motion.wheelbase
    turn = "steering" if wheelbase else "yaw rate"
    named: list[tuple[str, float, str, str]] = []
    for place, what, channel in (("V", "speed", actuator.v), ("OMEGA", turn, actuator.omega)):
        named += [
            (f"DELAY_{place}", channel.delay.value, f"[s] transport delay of the {what}", "delay"),
            (f"GAIN_{place}", channel.gain.value, f"drive over input, of the {what}", "gain"),
            (
                f"TIME_CONSTANT_{place}",
                channel.time_constant.value,
                f"[s] time constant of the {what}",
                "time_constant",
            ),
            (
                f"SLOW_FRACTION_{place}",
                channel.slow_fraction.value,
                f"fraction of the {what} that follows slowly",
                "slow_fraction",
            ),
            (
                f"SLOW_TIME_CONSTANT_{place}",
                channel.slow_time_constant.value,
                "[s] its time constant; 0 where there is none",
                "slow_time_constant",
            ),
        ]
    how = how_known(model)
    lines = [
        _define(name, value, what + how.get(f"{part}_{name.rpartition('_')[2].lower()}", ""))
        for name, value, what, part in named
    ]
    lines.append(_define("WHEELBASE", wheelbase, "[m] of a robot that steers; 0: it does not"))
    slip = model.content.parameters[: model.motion.slip_size]
    lines += [_define(f"P{i}", p.value, f"{p.name} [{p.unit}]{how[p.name]}") for i, p in enumerate(slip)]
    return "\n".join(lines)


def _range(model: Model) -> str:
    span = model.content.range
    rows = (
        ("SPEED_MIN", span.speed[0], "[m/s]"),
        ("SPEED_MAX", span.speed[1], "[m/s]"),
        ("YAW_RATE_MIN", span.yaw_rate[0], "[rad/s]"),
        ("YAW_RATE_MAX", span.yaw_rate[1], "[rad/s]"),
    )
    return "\n".join(_define(*row) for row in rows)


def _library(model: Model) -> str:
    """Return what slipwise::MotionModel is made from; the lists go between braces."""
    basis, motion = model.motion.basis, model.motion
    channels = (("LON", basis.lon), ("LAT", basis.lat), ("ANG", basis.ang))
    lists = [(f"TERMS_{name}", ", ".join(f'"{term}"' for term in terms)) for name, terms in channels]
    lists.append(("PARAMETERS", ", ".join(map(repr, model.mean.tolist()))))
    counts = [
        ("SLIP_PARAMETERS", motion.slip_size),
        ("PARAMETER_COUNT", motion.size),
        ("HAS_DYNAMICS", motion.dynamics),
        ("HAS_RESPONSE", motion.response),
        ("HAS_DELAYS", motion.delays),
        ("HAS_LAGS", motion.lags),
    ]
    lines = [f"#define SLIPWISE_{name} {text}".rstrip() for name, text in lists]
    return "\n".join([*lines, *(f"#define SLIPWISE_{name} {int(count)}" for name, count in counts)])


def _learned(model: Model) -> str:
    names = [f"SLIPWISE_P{i}" for i in range(model.motion.slip_size)] or ["0"]
    return "\n".join(f"  model.p[{i}] = {name};" for i, name in enumerate(names))


def _slip(model: Model) -> list[str]:
    """Return the body of the function of slip rates."""
    basis = model.motion.basis
    coefficients = _coefficients(basis)
    used: set[str] = set()
    sums: list[str] = []
    at = 0
    for channel, terms in enumerate((basis.lon, basis.lat, basis.ang)):
        products = []
        for term in terms:
            factors = _factors(term)
            used |= set(factors)
            scale = [] if coefficients[at] == 1.0 else [f"SLIPWISE_R({coefficients[at]!r})"]
            products.append(" * ".join((f"p[{at}]", *scale, *factors)))
            at += 1
        sums.append(f"rate[{channel}] = {' + '.join(products) or '0'};")
    regular = repr(_regular_curvature())
    made = [
        f"const slipwise_real {name} = {text.format(regular=regular)};"
        for name, text in _MADE.items()
        if name in used
    ]
    sideways = axes_of(model).sideways
    names = ("v", *(("vy",) if sideways else ()), "w", "gx", "gy")
    given = [f"(void){name};" for name in names if not any(name in line.split() for line in made)]
    given += [] if at else ["(void)p;"]
    return [*made, *given, *_parked(used, ("v", "w", *(("vy",) if sideways else ()))), *sums]


def _parked(used: set[str], moves: tuple[str, ...]) -> list[str]:
    """Return the lines that keep a parked robot from sliding down a slope."""
    slopes = sorted(used & {"gx", "gy"})
    if not slopes:
        return []
    moving = " || ".join(f"{name} < 0 || {name} > 0" for name in moves)
    return [f"if (!({moving})) {{", *(f"  {name} = 0;" for name in slopes), "}"]


def _factors(term: str) -> list[str]:
    """Return the quantities of a term in its canonical spelling, each as often as its power says."""
    factors = []
    for part in term.removesuffix("/g").split("*"):
        name, _, power = part.partition("^")
        if name in _QUANTITIES:
            factors += [_QUANTITIES[name]] * int(power or 1)
    return factors


def _coefficients(basis: _core.Basis) -> list[float]:
    """Return the number that each term starts with: its value where all quantities that it has are 1."""
    at_one = _core.SlipState(1.0, 1.0, 1.0, 1.0, 1.0)
    others = {
        "kappa": _core.Basis("curvature", ["kappa"], [], []),
        "third": _core.Basis("v3", ["V3"], [], []),
    }
    known = {name: float(other.features(at_one)[0]) for name, other in others.items()}
    terms = (*basis.lon, *basis.lat, *basis.ang)
    plain = []
    for value, term in zip(basis.features(at_one).tolist(), terms, strict=True):
        factors = _factors(term)
        plain.append(value / math.prod(number ** factors.count(name) for name, number in known.items()))
    return [1.0 if abs(value - 1.0) < 1e-12 else value for value in plain]


def _regular_curvature() -> float:
    """Return v0^2 of kappa = w V / (V^2 + v0^2) [m^2/s^2], as the core has it."""
    curvature = _core.Basis("curvature", ["kappa"], [], [])
    slow = float(curvature.features(_core.SlipState(_PROBE, 1.0, 0.0, 0.0))[0])
    return _PROBE / slow - _PROBE**2


def limits(model: Model) -> str:
    """Return the limits as constants, for the header itself and for the C++ library."""
    of_drive = model.limits or _core.CommandLimits(_NONE, _NONE, _NONE, 1.0, 1.0, 1.0)
    axes = {"SPEED": of_drive.speed, "YAW_RATE": of_drive.yaw_rate, "SIDE": of_drive.side}
    lines = [
        "/* Limits of the drive, before delay and lag: dead-band, saturation, slew rates, their lag. */",
        *_said(model),
    ]
    lines += [f"#define SLIPWISE_LIMITS_{name} {_axis(axis)}" for name, axis in axes.items()]
    lines += [
        f"#define SLIPWISE_LIMITS_WHEEL_SEPARATION SLIPWISE_R({of_drive.wheel_separation!r})  /* [m] */",
        f"#define SLIPWISE_LIMITS_GAIN_V SLIPWISE_R({of_drive.gain_v!r})  /* of what the sides are asked */",
        f"#define SLIPWISE_LIMITS_GAIN_OMEGA SLIPWISE_R({of_drive.gain_omega!r})",
        f"#define SLIPWISE_LIMITS_SIDES {int(_axis(of_drive.side) != _axis(_NONE))}",
    ]
    return "\n".join(lines)


def how_known(model: Model) -> dict[str, str]:
    """Return how well each learned number is known, as the end of a comment, by names without `log_`.

    A number that is not identified stays in the header, which predicts what the model does; it says so.
    """
    not_identifiable = {physical_name(row.name) for row in model.table.rows if not row.identifiable}
    return {
        p.name: f", {' +- '.join(estimate_texts(p.value, p.std))}"
        + ("" if p.identified and p.name not in not_identifiable else ", not identified")
        for p in physical_parameters(model)
    }


def _said(model: Model) -> list[str]:
    how = how_known(model)
    return [f"/* {name}{text} */" for name, text in how.items() if name.startswith("limits.")]


def cursor(model: Model) -> str:
    """Return how the header walks over the commands: with their limits, where there are some."""
    name = "cursor_template.h" if model.limits is None else "limits_template.h"
    text = files("slipwise.export").joinpath(name).read_text(encoding="utf-8")
    return text.replace("@PIECE@", repr(_core.RAMP_PIECE))


def _axis(axis: _core.AxisLimits) -> str:
    values: list[float] = [getattr(axis, name) for name in KINDS]
    return ", ".join("INFINITY" if math.isinf(value) else repr(value) for value in values)
