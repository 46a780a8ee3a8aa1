# SPDX-License-Identifier: Apache-2.0
"""What an evaluation returns: every prediction beside its measurement, and scores per method and horizon."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import ErrorSummary
from slipwise.frames import data_frame
from slipwise.logs.findings.finding import Finding
from slipwise.logs.log import LeftOut
from slipwise.number_text import number_text

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Score:
    """One method at one horizon."""

    method: str
    causal: bool  # False: learned from the whole log, the windows judged included
    horizon: float  # s
    windows: int
    position: ErrorSummary  # m
    heading: ErrorSummary  # rad
    percent_of_distance: float  # mean position error / mean straight-line distance of the windows * 100
    position_ratio: tuple[float, float, float]  # mean error relative to `none`: value, low, high
    heading_ratio: tuple[float, float, float]
    position_to_rival: float  # mean error relative to the best other method than `none`
    heading_to_rival: float
    in_sample_position: float  # m, thesis-style residual: too optimistic, for comparison with Table 6.2
    in_sample_heading: float  # rad
    nis: float  # mean normalised innovation squared; 3 where the covariance is true
    nis_band: tuple[float, float]  # where its mean should lie with 95 %
    coverage: tuple[float, float, float]  # fraction of windows inside the 50, 90, 95 % ellipsoids
    reported_nis: float  # the same two where no inflation and no tails are learned from earlier errors:
    reported_coverage: tuple[float, float, float]  # a filter's usual covariance, and normal ellipsoids

    def __repr__(self) -> str:
        position, heading = number_text(self.position.mean), number_text(self.heading.mean)
        return f"<Score of {self.method} after {self.horizon:g} s: {position} m, {heading} rad>"

    def flat(self) -> dict[str, Any]:
        """Return all numbers under names of one level."""
        row: dict[str, Any] = {}
        for name, value in asdict(self).items():
            if isinstance(value, dict):
                row |= {f"{name}_{part}": item for part, item in value.items()}
            elif isinstance(value, tuple):
                row |= {f"{name}_{part}": item for part, item in zip(_parts(name), value, strict=True)}
            else:
                row[name] = value
        return row


def embargo_sentence(embargo: float | None) -> str:
    """Say how old what predictions were made from is."""
    age = "one horizon" if embargo is None else f"{embargo:g} s"
    return f"Nothing measured within {age} before a prediction was learned for it."


def _parts(name: str) -> tuple[str, ...]:
    """What the numbers of a tuple in a score are."""
    if name.endswith("coverage"):
        return ("50", "90", "95")
    return ("low", "high") if name.endswith("band") else ("value", "low", "high")


def scores_html(scores: tuple[Score, ...]) -> str:
    """Return a table of mean errors as a fragment of HTML; every text in it is escaped."""
    head = "".join(f"<th>{name}</th>" for name in ("method", "horizon [s]", "position [m]", "heading [rad]"))
    rows = (
        (s.method, f"{s.horizon:g}", number_text(s.position.mean), number_text(s.heading.mean))
        for s in scores
    )
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The result of `slipwise.evaluate`."""

    input: str  # "command" or "wheel"
    horizons: tuple[float, ...]  # s
    methods: tuple[str, ...]
    scores: tuple[Score, ...]  # over the second half of the windows
    predictions: tuple[Predictions, ...]  # of all windows
    runs: tuple[str, ...]  # run names
    left_out: tuple[LeftOut, ...]
    notes: tuple[str, ...]
    models: tuple[str, ...] = ()  # those of the methods that are model files as they are
    contradictions: tuple[Finding, ...] = ()  # between the poses and the inputs of the log
    positions: bool = False  # only positions were measured
    embargo: float | None = None  # s before a prediction from which nothing was learned; None: its horizon
    clocks_compared: bool = False  # header stamps were compared with the times of receipt

    def __repr__(self) -> str:
        longest = max(self.horizons)
        scores = [score for score in self.scores if score.horizon == longest]
        errors = ", ".join(f"{score.method} {number_text(score.position.mean)} m" for score in scores)
        return f"<Evaluation from {self.input}s: after {longest:g} s {errors}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: a table of mean errors."""
        return scores_html(self.scores)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the scores as a pandas data frame, a method and horizon a row; m and rad.

        Parts of a score are columns of their own, such as `position_mean` or `position_ratio_low`.

        Raises:
            SlipwiseError: pandas is not installed.
        """
        rows = [score.flat() for score in self.scores]
        return data_frame({name: [row[name] for row in rows] for name in rows[0]} if rows else {})

    def score(self, method: str, horizon: float) -> Score:
        """Return the score of `method` at `horizon`; KeyError where there is none."""
        for score in self.scores:
            if score.method == method and score.horizon == horizon:
                return score
        raise KeyError((method, horizon))


__all__ = ["ErrorSummary", "Evaluation", "Predictions", "Score"]
