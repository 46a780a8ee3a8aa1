# SPDX-License-Identifier: Apache-2.0
"""The verdict on an evaluation: does the learned method beat doing nothing, and what is not determined."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.calibration import Calibration, Verdict
    from slipwise.evaluation import Evaluation
    from slipwise.models import Model

#: What learns nothing, or nothing causally, and rivals that no model file can hold.
_NOT_JUDGED = ("none", "vendor", "batch", "slip-ratio-ekf", "slip-ratio-smo")


def judged_method(methods: tuple[str, ...], models: tuple[str, ...] = ()) -> str | None:
    """Return the method judged: the first model file, else `auto`, else the first that learns; or None."""
    names = [name for name in methods if name not in _NOT_JUDGED]
    return next((name for name in (*models, "model", "auto") if name in names), names[0] if names else None)


def verdict_on(evaluation: Evaluation, source: Calibration | Model | None) -> Verdict | None:
    """Judge the learned method against `none` at the longest horizon; None where no method learns.

    Args:
        evaluation: with `none` among its methods.
        source: what says which parameters are not determined: the calibration, or the model judged.
    """
    from slipwise.calibration import Calibration, Settings
    from slipwise.calibration.plain import plain_forecaster
    from slipwise.calibration.verdict import give_verdict, judge
    from slipwise.models.parameter_table import physical_name

    method = judged_method(evaluation.methods, evaluation.models)
    longest = {p.method: p for p in evaluation.predictions if p.horizon == max(evaluation.horizons)}
    if method is None or source is None:
        return None
    nothing_learned = plain_forecaster(Settings()).belief(0)
    verdict = give_verdict(judge(longest[method], longest["none"]), nothing_learned, wheels_logged=False)
    known = source.verdict if isinstance(source, Calibration) else source.content.verdict
    advice = (*verdict.advice, *known.advice)
    if not evaluation.score(method, max(evaluation.horizons)).causal:
        advice = (*advice, "The model was learned from this very log: judge it on another drive.")
    undetermined = tuple(known.undetermined)
    sentence = verdict.sentence
    if undetermined:
        sentence += f" Not determined: {', '.join(map(physical_name, undetermined))}."
    return replace(
        verdict,
        sentence=sentence,
        undetermined=undetermined,
        advice=tuple(dict.fromkeys(advice)),
        timing=known.timing,
    )
