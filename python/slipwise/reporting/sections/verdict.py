# SPDX-License-Identifier: Apache-2.0
"""The verdict in one sentence, the figures behind it, and what to drive next."""

from __future__ import annotations

import math
from collections.abc import Callable

from slipwise.calibration.result import Verdict
from slipwise.evaluation.result import ErrorSummary
from slipwise.reporting.contents import PLAIN, Contents
from slipwise.reporting.markup import bullets, escape, number, paragraph

_STATES = {
    "good": "✓ Good",
    "partly": "▲ Good, but not everything is determined",
    "reserved": "▲ Good, with reservations",
    "bad": "✕ Not good enough",
}


class VerdictSection:
    """May the model be used?"""

    title = "Verdict"
    explanation = "Whether the learned model may be used, judged on driving that it had not learned from."

    def html(self, contents: Contents) -> str:
        """Return the verdict, the two main scores, and the advice."""
        verdict = contents.calibration.verdict
        state = _state(verdict)
        banner = (
            f'<div class="verdict {state}" role="status"><strong>{_STATES[state]}</strong>'
            f"{paragraph(verdict.sentence)}</div>"
        )
        return banner + _tiles(contents) + _undetermined(verdict)


def _state(verdict: Verdict) -> str:
    if not verdict.good:
        return "bad"
    if verdict.reservations:
        return "reserved"
    return "partly" if verdict.undetermined else "good"


def _tiles(contents: Contents) -> str:
    """The mean errors at the longest horizon beside the plain model's."""
    horizon, method = contents.longest_horizon, contents.learned_method
    learned, plain = contents.score(method, horizon), contents.score(PLAIN, horizon)
    if learned is None or plain is None or horizon is None:
        return paragraph("There are no held-out scores beside the plain model's.", kind="missing")
    position = _tile(f"Position error after {horizon:g} s", learned.position, plain.position, _metres)
    heading = _tile(f"Heading error after {horizon:g} s", learned.heading, plain.heading, _degrees)
    return f'<div class="tiles">{position}{heading}</div>'


def _tile(name: str, learned: ErrorSummary, plain: ErrorSummary, shown: Callable[[float], str]) -> str:
    usable = plain.mean > 0.0 and math.isfinite(learned.mean)
    change = f": {_change(learned.mean / plain.mean)}" if usable else ""
    return (
        f'<div class="tile"><span>{escape(name)}</span><b>{escape(shown(learned.mean))}</b>'
        f"<span>{escape(f'instead of {shown(plain.mean)} without slip{change}')}</span></div>"
    )


def _metres(value: float) -> str:
    return f"{number(value)} m"


def _degrees(value: float) -> str:
    return f"{number(math.degrees(value))}° ({number(value)} rad)"


def _change(ratio: float) -> str:
    percent = round(100.0 * abs(1.0 - ratio))
    return "the same" if percent == 0 else f"{percent} % {'less' if ratio < 1.0 else 'more'}"


def _undetermined(verdict: Verdict) -> str:
    html = ""
    if verdict.undetermined:
        html += paragraph("This log does not determine: " + ", ".join(verdict.undetermined) + ".")
    if verdict.advice:
        html += paragraph("What to do:") + bullets(verdict.advice)
    if verdict.look_alikes:
        pairs = ", ".join(map(str, verdict.look_alikes))
        html += paragraph(f"Hard to tell apart (correlation of their errors): {pairs}.")
    if verdict.timing:
        html += paragraph(verdict.timing)
    return html
