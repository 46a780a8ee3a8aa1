# SPDX-License-Identifier: Apache-2.0
"""What a model has learned, in an engineer's words, built from identified numbers alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Protocol

from slipwise.argument_types import check_arguments
from slipwise.models.body_lag import body_lag_sentences
from slipwise.models.channel_words import response_sentences
from slipwise.models.limits import KINDS
from slipwise.models.model import Model
from slipwise.models.mounted import mount_sentences
from slipwise.models.parameter_table import PhysicalParameter, physical_parameters
from slipwise.models.schema import HeldOut
from slipwise.models.sensor_look import sensor_sentences
from slipwise.models.share_words import share_sentences
from slipwise.models.slip_words import slip_sentences
from slipwise.number_text import estimate_text, estimate_texts, number_text

BETTER = 1.05  # times; a smaller gain over the baseline is not given as a number
SIGNIFICANT = 2.0  # standard deviations from zero from which on an offset is said
_AXES = {"speed": "speed", "yaw_rate": "yaw rate", "side": "each side"}
_NO_SLIP = "What was learned is not slip: poses and inputs of the log contradict each other."
_SENSOR_PLACES = (("sensor_x", "ahead of", "behind"), ("sensor_y", "left of", "right of"))
_HEAD = ("parameter", "value", "std", "unit", "identified")


class Judged(Protocol):
    """A verdict on a log, or that in a model file."""

    @property
    def good(self) -> bool: ...  # noqa: D102

    @property
    def reservations(self) -> Sequence[str]: ...  # noqa: D102


def verdict_label(verdict: Judged) -> tuple[str, str]:
    """Return what a verdict says in a few words, and its colour."""
    if verdict.good and verdict.reservations:
        return "GOOD, WITH RESERVATIONS.", "yellow"
    return ("GOOD.", "green") if verdict.good else ("NOT GOOD ENOUGH.", "red")


@dataclass(frozen=True)
class Summary:
    """What a model says, in plain text, and the table behind it."""

    sentences: tuple[str, ...]
    parameters: tuple[PhysicalParameter, ...]  # all of them, limits included
    prediction: tuple[str, ...] = ()  # those of the sentences that say how well the model predicts

    def __str__(self) -> str:
        return " ".join(self.sentences)


def summarise(model: Model) -> Summary:
    """Say what was learned: slip, response, limits, offsets, and how well it predicts."""
    check_arguments(summarise, locals())
    parameters = physical_parameters(model)
    if model.content.verdict.contradictions:
        return Summary((_NO_SLIP,), parameters)
    sentences = [
        *slip_sentences(model, parameters),
        *share_sentences(model),
        *response_sentences(model.body, physical_parameters(model.body)),
        *body_lag_sentences(model),
        *_limit_sentences(parameters),
        *_offset_sentences(parameters, model),
        *sensor_sentences(model),
        *mount_sentences(model),
    ]
    prediction = tuple(_prediction_sentences(model))
    return Summary((*sentences, *prediction), parameters, prediction)


def _limit_sentences(parameters: tuple[PhysicalParameter, ...]) -> list[str]:
    parts = []
    for axis, name in _AXES.items():
        of_axis = [p for p in parameters if p.name.startswith(f"limits.{axis}.") and p.identified]
        said = [f"{KINDS[p.name.rpartition('.')[2]].words} {_amount(p)}" for p in of_axis]
        if said:
            parts.append(f"{name}: {', '.join(said)}")
    return [f"Actuator limits of {'; '.join(parts)}."] if parts else []


def _offset_sentences(parameters: tuple[PhysicalParameter, ...], model: Model) -> list[str]:
    found = {p.name: p for p in parameters if p.identified and abs(p.value) > SIGNIFICANT * p.std}
    sentences = []
    step = model.content.range.wheel_step
    late, std = model.motion.lateness(model.mean, model.covariance, step) or (0.0, 0.0)
    if abs(late) > step / 2.0 + SIGNIFICANT * std:
        seconds = estimate_text(abs(late), std)
        sentences.append(_later(seconds) if late > 0.0 else _late_wheels(seconds, model.content.input))
    parts = [
        f"{estimate_text(abs(place.value), place.std)} m {plus if place.value > 0.0 else minus}"
        for name, plus, minus in _SENSOR_PLACES
        if (place := found.get(name)) is not None
    ]
    if parts:
        sentences.append(f"The pose sensor sits {' and '.join(parts)} base_link.")
    yaw = found.get("sensor_yaw")
    if yaw is not None:
        degrees = estimate_text(math.degrees(yaw.value), math.degrees(yaw.std))
        sentences.append(f"The pose sensor is turned by {degrees} deg.")
    return sentences


def _later(seconds: str) -> str:
    """Poses tell a late stamp and a body that follows its wheels late by the same number."""
    return (
        f"Poses come {seconds} s later than wheel speeds of the same motion: they are stamped late, or the "
        "robot follows its wheels so much later (tracks, soft tyres). Another sensor or a check of the "
        "stamps tells which; a fusion should shift stamps in the first case alone."
    )


def _late_wheels(seconds: str, input_name: str) -> str:
    table = "; delays in the table are to them" if input_name == "command" else ""
    return f"Wheel speeds are stamped {seconds} s late, as no pose is stamped before it happens{table}."


def _prediction_sentences(model: Model) -> list[str]:
    held_out = model.content.verdict.held_out
    if held_out is None or held_out.segments == 0:
        return []
    if held_out.turns_alone:
        learned, plain = _turn(held_out.heading), _turn(held_out.baseline_heading)
        reached = f"Predicts the heading {held_out.horizon:g} s ahead to {learned}"
        return [f"{reached}, where the kinematic baseline misses by {plain}; positions were not measured."]
    reached = f"Predicts {held_out.horizon:g} s ahead to {_errors(held_out.position, held_out.heading)}"
    times = _times_better(held_out)
    if model.content.verdict.good and times:
        return [f"{reached}, {times} better than the kinematic baseline."]
    baseline = _errors(held_out.baseline_position, held_out.baseline_heading)
    return [f"{reached}, where the kinematic baseline misses by {baseline}."]


def _times_better(held_out: HeldOut) -> str:
    """How many times better position and heading are; empty where one of them is not."""
    pairs = ((held_out.baseline_position, held_out.position), (held_out.baseline_heading, held_out.heading))
    if any(learned <= 0.0 or plain < BETTER * learned for plain, learned in pairs):
        return ""
    position, heading = (
        f"{plain / learned:.0f}" if plain > 10.0 * learned else number_text(plain / learned, 2)
        for plain, learned in pairs
    )
    return f"{position} times" if position == heading else f"{position} and {heading} times"


def _errors(position: float, heading: float) -> str:
    return f"{number_text(position)} m and {_turn(heading)}"


def _turn(heading: float) -> str:
    return f"{number_text(heading)} rad ({number_text(math.degrees(heading))} deg)"


def _amount(parameter: PhysicalParameter) -> str:
    return f"{estimate_text(parameter.value, parameter.std)} {parameter.unit}"


def model_html(model: Model) -> str:
    """Return what a notebook shows of a model, as a fragment of HTML; every text in it is escaped."""
    content, summary = model.content, summarise(model)
    head = f"<b>{escape(content.slip.basis)}</b> learned from {escape(content.input)}s"
    sentences = "".join(f"<li>{escape(sentence)}</li>" for sentence in summary.sentences)
    state = "Good." if content.verdict.good else "Not good enough."
    verdict = f"<p><b>{state}</b> {escape(content.verdict.sentence)}</p>"
    return f"<div><p>{head}</p><ul>{sentences}</ul>{verdict}{_table(summary.parameters)}</div>"


def _table(parameters: tuple[PhysicalParameter, ...]) -> str:
    head = "".join(f"<th>{name}</th>" for name in _HEAD)
    rows = "".join(_row(parameter) for parameter in parameters)
    count = f"{len(parameters)} parameters" if len(parameters) != 1 else "1 parameter"
    return (
        f"<details><summary>{count}</summary><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{rows}</tbody></table></details>"
    )


def _row(parameter: PhysicalParameter) -> str:
    value, std = estimate_texts(parameter.value, parameter.std)
    cells = (parameter.name, value, std, parameter.unit, "yes" if parameter.identified else "no")
    return "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"
