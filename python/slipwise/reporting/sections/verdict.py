# SPDX-License-Identifier: Apache-2.0
"""The answer on one screen: does the model help, how much, what was learned, what to do."""

from __future__ import annotations

import math

from slipwise.calibration.next_step import after_learning, check_command, export_command
from slipwise.calibration.result import Verdict
from slipwise.models.inputs import MANY
from slipwise.models.parameter_table import physical_name
from slipwise.models.summary import BETTER, summarise, verdict_label
from slipwise.reporting.contents import PLAIN, Contents
from slipwise.reporting.markup import bullets, details, escape, number, paragraph
from slipwise.reporting.method_names import BASELINE
from slipwise.reporting.sections.paths import typical_path
from slipwise.reporting.uncertainty import honesty_of

_BANNERS = {"green": ("good", "✓"), "yellow": ("reserved", "▲"), "red": ("bad", "✕")}
_SHOWN_AT_ONCE = 4  # pieces of advice; the others are folded away


class VerdictSection:
    """May the model be used?"""

    title = "Does the learned model help?"
    explanation = "Judged on held-out windows: each was predicted before the model learned from it."

    def html(self, contents: Contents) -> str:
        """Return the verdict, the main errors, a predicted path, what to do, and what was learned."""
        verdict = contents.calibration.verdict
        words, colour = verdict_label(verdict)
        state, mark = _BANNERS[colour]
        banner = (
            f'<div class="verdict {state}" role="status"><strong>{mark} {escape(words)}</strong>'
            f"{paragraph(verdict.sentence)}</div>"
        )
        drawn = typical_path(contents)
        columns = [_column("What to do", _to_do(contents)), _column("What was learned", _learned(contents))]
        if drawn:
            columns.insert(0, _column("What was predicted: a typical path", drawn))
        shown = f'<div class="columns">{"".join(columns)}</div>'
        return banner + _tiles(contents) + shown + _other_input(contents)


def _other_input(contents: Contents) -> str:
    """What the same model says from its other input, folded away; empty where it has none."""
    model = contents.calibration.model
    if len(model.inputs) < 2:
        return ""
    other = model.of_input(model.inputs[1])
    label = verdict_label(other.verdict)[0]
    said = (*summarise(other).sentences, f"{label} {other.verdict.sentence}")
    return details(f"The same model from {MANY[other.content.input]}", bullets(said))


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
    if max(plain / learned, learned / plain) < BETTER:
        return ", about the same"
    if plain >= learned:
        return f", {number(plain / learned, 2)} times as much"
    return f", {number(learned / plain, 2)} times less"


def _column(heading: str, html: str) -> str:
    return f"<div><h3>{escape(heading)}</h3>{html}</div>"


def _learned(contents: Contents) -> str:
    verdict = contents.calibration.verdict
    summary = summarise(contents.calibration.model)
    sentences = [text for text in summary.sentences if text not in summary.prediction]  # tiles show those
    if verdict.not_identifiable:
        sentences.append(
            f"Not identifiable from this log: {', '.join(map(physical_name, verdict.not_identifiable))}."
        )
    return (
        bullets(sentences) if sentences else paragraph("The model has nothing to say: it has no parameters.")
    )


def _to_do(contents: Contents) -> str:
    """First the check, then the export, then the drives that are missing."""
    verdict = contents.calibration.verdict
    if not verdict.good:
        return bullets(("Do not use this model.", *after_learning(verdict, contents.model))) + _advice(
            verdict
        )
    commands = (
        ("Check it on another day:", check_command(contents.model)),
        ("Export it:", export_command(contents.model)),
    )
    items = "".join(f"<li>{escape(what)} <code>{_words(command)}</code></li>" for what, command in commands)
    return f"<ul>{items}</ul>{_advice(verdict)}"


def _words(command: str) -> str:
    """Return a command line that wraps between its words alone, not inside of `--to`."""
    return " ".join(f"<span>{escape(word)}</span>" for word in command.split(" "))


def _advice(verdict: Verdict) -> str:
    """Return what the terminal says below the next step; what is long is folded away."""
    texts = [text for text in (*verdict.advice, verdict.timing, verdict.force) if text]
    first, rest = texts[:_SHOWN_AT_ONCE], texts[_SHOWN_AT_ONCE:]
    return (bullets(first) if first else "") + (details(f"{len(rest)} more", bullets(rest)) if rest else "")
