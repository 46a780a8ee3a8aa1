# SPDX-License-Identifier: Apache-2.0
"""The answer on one screen: does the model help, how much, what was learned, what to do."""

from __future__ import annotations

import math
from pathlib import Path

from slipwise.calibration.next_step import check_command, export_command
from slipwise.calibration.result import Verdict
from slipwise.models.summary import summarise
from slipwise.reporting.contents import PLAIN, Contents
from slipwise.reporting.markup import bullets, escape, number, paragraph
from slipwise.reporting.method_names import BASELINE
from slipwise.reporting.uncertainty import honesty_of

_STATES = {
    "good": "✓ Good",
    "partly": "▲ Good, but not everything can be identified",
    "reserved": "▲ Good, with reservations",
    "bad": "✕ Not good enough",
}


class VerdictSection:
    """May the model be used?"""

    title = "Does the learned model help?"
    explanation = (
        "Judged on held-out windows: each was predicted before anything in it, or one horizon before it, was "
        "learned."
    )

    def html(self, contents: Contents) -> str:
        """Return the verdict, the main errors, what was learned, and what to do."""
        verdict = contents.calibration.verdict
        state = _state(verdict)
        banner = (
            f'<div class="verdict {state}" role="status"><strong>{_STATES[state]}</strong>'
            f"{paragraph(verdict.sentence)}</div>"
        )
        columns = _column("What was learned", _learned(contents)) + _column("What to do", _to_do(verdict))
        return banner + _tiles(contents) + f'<div class="columns">{columns}</div>'


def _state(verdict: Verdict) -> str:
    if not verdict.good:
        return "bad"
    if verdict.reservations:
        return "reserved"
    return "partly" if verdict.not_identifiable else "good"


def _tiles(contents: Contents) -> str:
    """The mean errors at the longest horizon beside the baseline's, and whether the covariance is true."""
    horizon, method = contents.longest_horizon, contents.learned_method
    learned, plain = contents.score(method, horizon), contents.score(PLAIN, horizon)
    if learned is None or plain is None or horizon is None:
        return paragraph(f"There are no held-out errors beside those of the {BASELINE}.", kind="missing")
    position, heading = learned.position.mean, learned.heading.mean
    tiles = [
        _tile(
            f"Position error after {horizon:g} s",
            "not measured" if position == plain.position.mean == 0.0 else f"{number(position)} m",
            f"{BASELINE}: {number(plain.position.mean)} m{_times(position, plain.position.mean)}",
        ),
        _tile(
            f"Heading error after {horizon:g} s",
            f"{number(math.degrees(heading))}° ({number(heading)} rad)",
            f"{BASELINE}: {number(math.degrees(plain.heading.mean))}°{_times(heading, plain.heading.mean)}",
        ),
    ]
    honesty = honesty_of(learned)
    if honesty is not None:
        tiles.append(_tile("Is the reported uncertainty true?", honesty.answer, honesty.short))
    return f'<div class="tiles">{"".join(tiles)}</div>'


def _tile(name: str, value: str, beside: str) -> str:
    return (
        f'<div class="tile"><span>{escape(name)}</span><b>{escape(value)}</b>'
        f"<span>{escape(beside)}</span></div>"
    )


def _times(learned: float, plain: float) -> str:
    """Say how many times larger or smaller the baseline's error is; empty if that has no meaning."""
    if not (learned > 0.0 and plain > 0.0 and math.isfinite(learned / plain)):
        return ""
    if plain >= learned:
        return f", {number(plain / learned, 2)} times as much"
    return f", {number(learned / plain, 2)} times less"


def _column(heading: str, html: str) -> str:
    return f"<div><h3>{escape(heading)}</h3>{html}</div>"


def _learned(contents: Contents) -> str:
    verdict = contents.calibration.verdict
    sentences = list(summarise(contents.calibration.model).sentences)
    if verdict.not_identifiable:
        sentences.append(f"Not identifiable from this log: {', '.join(verdict.not_identifiable)}.")
    return (
        bullets(sentences) if sentences else paragraph("The model has nothing to say: it has no parameters.")
    )


def _to_do(verdict: Verdict) -> str:
    if verdict.good:
        model = Path("model.yaml")
        steps = (f"Check it on another day: {check_command(model)}", f"Export it: {export_command(model)}")
        return bullets((*verdict.advice, *steps))
    return bullets(("Do not use this model.", *verdict.advice))
