# SPDX-License-Identifier: Apache-2.0
"""The state of the node in the words of ROS diagnostics: a level, a sentence, and keys with values."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

from slipwise.live.outputs import Note, ParameterNow, Status, SurfaceNow


class Level(IntEnum):
    """As `diagnostic_msgs/msg/DiagnosticStatus` counts."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True)
class Diagnostic:
    """One line of a diagnostics viewer."""

    level: Level
    name: str
    message: str
    values: tuple[tuple[str, str], ...] = ()


#: Waiting is stale: nothing comes. A closed gate, such as that of standstill, is no fault.
_OF_STATE = {"learning": Level.OK, "not learning": Level.OK, "waiting": Level.STALE, "stuck": Level.ERROR}
_OF_VALIDITY = {"estimated": Level.OK, "unestimated": Level.WARN, "invalid": Level.ERROR}


def diagnostics_of(status: Status, name: str) -> tuple[Diagnostic, ...]:
    """Return what `status` says: of the node, of the model, and of its parameters; `name` is the node's."""
    return (
        Diagnostic(
            _OF_STATE.get(status.state, Level.WARN),
            f"{name}: state",
            _sentence(status.state, status.why),
            _state_values(status),
        ),
        Diagnostic(
            _OF_VALIDITY.get(status.validity, Level.WARN),
            f"{name}: model",
            _sentence(status.validity, status.validity_why),
            _model_values(status),
        ),
        Diagnostic(
            max((_OF_VALIDITY.get(p.validity, Level.WARN) for p in status.parameters), default=Level.WARN),
            f"{name}: parameters",
            _parameters_sentence(status.parameters),
            tuple(pair for parameter in status.parameters for pair in _parameter_values(parameter)),
        ),
        *([] if status.surface is None else [_surface(status.surface, name)]),
    )


def _surface(now: SurfaceNow, name: str) -> Diagnostic:
    """The surface that is driven on; that it is open is no fault."""
    judged, right = now.labels
    values = [
        (f"probability of {surface_name(each)}", _number(value)) for each, value in now.probabilities
    ] + [
        (f"remembered: {each.name}", f"{each.seconds / 60.0:.1f} min, {each.visits} visits, {each.last_seen}")
        for each in now.remembered
    ]
    return Diagnostic(
        Level.OK,
        f"{name}: surface",
        f"{surface_name(now.name)} ({now.probability:.2f})",
        (*values, ("labels right", f"{right:g} of {judged:g}")),
    )


def surface_name(name: str) -> str:
    """Return how a surface is called in words: it gets a name when it is left."""
    return name or "a new surface"


def note_diagnostic(note: Note, name: str) -> Diagnostic:
    """Return a note as a line of its own."""
    return Diagnostic(Level.OK, f"{name}: note", note.text)


def _sentence(what: str, why: str) -> str:
    return f"{what}: {why}" if why else what


def _state_values(status: Status) -> tuple[tuple[str, str], ...]:
    values = [("vehicle", status.vehicle), ("input", status.input), ("apply", status.apply)]
    if status.odometry is not None:
        values.append(("dead reckoning [s]", _number(status.odometry.since_pose)))
    if status.slip is not None:
        names = ("slip forward [m/s]", "slip sideways [m/s]", "slip yaw rate [rad/s]")
        values += zip(names, map(_number, status.slip.tolist()), strict=True)
    values += [(f"rejected: {reason}", str(count)) for reason, count in status.counts.items()]
    return tuple(values)


def _model_values(status: Status) -> tuple[tuple[str, str], ...]:
    values = [("segments", str(status.segments))]
    if status.given:
        values.append(("others have", status.given))
    if status.nis is not None:
        values.append(("NIS (3 expected)", _number(status.nis)))
    if status.held_out is not None:
        names = (
            "held-out position error [m]",
            "held-out heading error [rad]",
            "baseline's position error [m]",
            "baseline's heading error [rad]",
        )
        values += zip(names, map(_number, status.held_out), strict=True)
    return tuple(values)


def _parameters_sentence(parameters: tuple[ParameterNow, ...]) -> str:
    if not parameters:
        return "no parameter yet"
    known = sum(p.validity == "estimated" for p in parameters)
    return f"{known} of {len(parameters)} estimated"


def _parameter_values(parameter: ParameterNow) -> tuple[tuple[str, str], ...]:
    """Return what a machine reads too: numbers alone, the unit beside."""
    name = parameter.name
    return (
        (name, _number(parameter.value)),
        (f"{name} std", _number(parameter.std)),
        (f"{name} prior std", _number(parameter.prior_std)),
        (f"{name} unit", parameter.unit or "1"),
        (f"{name} validity", parameter.validity),
        (f"{name} start", _number(parameter.start)),
        (f"{name} applied", "nothing" if parameter.applied is None else _number(parameter.applied)),
    )


def _number(value: float) -> str:
    """Return a number with six significant digits, as machines read it."""
    return f"{value:.6g}" if math.isfinite(value) else str(value)
