# SPDX-License-Identifier: Apache-2.0
"""The parts of the JSON documents that several commands write."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from slipwise.addresses import masked

if TYPE_CHECKING:
    from slipwise.calibration import Calibration, Verdict
    from slipwise.calibration.learned_sequence import LearnedSequence
    from slipwise.evaluation import Evaluation
    from slipwise.logs import LeftOut, Log
    from slipwise.models import Model


def head(command: str) -> dict[str, Any]:
    """Return what every document starts with."""
    return {
        "command": command,
        "arguments": [masked(argument) for argument in sys.argv[1:]],
        "slipwise_version": version("slipwise"),
    }


def log_part(log: Log, left_out: Sequence[LeftOut]) -> dict[str, Any]:
    """Return where a log came from, what was guessed and what was left out."""
    return {
        "sources": [asdict(source) for source in log.sources],
        "notes": list(log.notes),
        "left_out": [asdict(entry) for entry in left_out],
    }


def surfaces_part(model: Model) -> list[dict[str, Any]]:
    """Return facts about each surface that a model remembers, without its slip."""
    learned = {"slip", "covariance", "memory"}
    return [surface.model_dump(exclude=learned) for surface in model.content.surfaces]


def shares_part(model: Model) -> dict[str, Any] | None:
    """Return what arrives of commands, by axis; None where the log does not say it."""
    shares = model.content.shares
    return None if shares is None else shares.model_dump(exclude_none=True)


def mounts_part(calibration: Calibration) -> list[dict[str, Any]]:
    """Return where further sources of poses sit (x, y [m], yaw [rad]) and how late they are [s]."""
    names = ("x", "y", "yaw", "late")
    return [
        {"name": mount.name, "beside": mount.beside, "seconds": mount.seconds}
        | dict(zip(names, mount.value.tolist(), strict=True))
        | {f"{name}_std": std for name, std in zip(names, mount.std.tolist(), strict=True)}
        for mount in calibration.mounts
    ]


def memory_part(learned: LearnedSequence) -> dict[str, Any]:
    """Return the surfaces that are remembered after a sequence of logs, and what labels were worth."""
    return {
        "surfaces": [asdict(surface) for surface in learned.surfaces],
        "labels": dict(zip(("all", "right"), learned.labels, strict=True)),
    }


def verdict_part(verdict: Verdict | None) -> dict[str, Any] | None:
    """Return a verdict."""
    return None if verdict is None else asdict(verdict)


def calibration_part(calibration: Calibration) -> dict[str, Any]:
    """Return what was learned, in the units of the model file."""
    from slipwise.models.summary import summarise

    content, history = calibration.model.content, calibration.history
    limits = calibration.model.limits_section
    alarms = [] if history is None else history.alarms()
    return {
        "input": content.input,
        "basis": content.slip.basis,
        "summary": list(summarise(calibration.model).sentences),
        "parameters": [parameter.model_dump() for parameter in content.parameters],
        "limits": None if limits is None else limits.model_dump(),
        "held_out": content.verdict.held_out.model_dump() if content.verdict.held_out else None,
        "shares": shares_part(calibration.model),
        "learned_segments": content.provenance.learned_segments,
        "learned_seconds": content.provenance.learned_seconds,
        "terrain_changes": [{"run": run, "t": t} for run, t in alarms],
    }


def evaluation_part(evaluation: Evaluation) -> dict[str, Any]:
    """Return all scores, in m and rad."""
    return {
        "input": evaluation.input,
        "horizons": list(evaluation.horizons),
        "embargo": evaluation.embargo,
        "methods": list(evaluation.methods),
        "scores": [asdict(score) for score in evaluation.scores],
    }
