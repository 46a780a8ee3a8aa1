# SPDX-License-Identifier: Apache-2.0
"""What was learned of a user's dynamics: parameters, deviations and a verdict, and predictions with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.argument_types import check_arguments
from slipwise.dynamics.dynamics import Dynamics
from slipwise.errors import SettingsError
from slipwise.models.schema import UNIDENTIFIABLE_RATIO
from slipwise.number_text import number_text

Floats = NDArray[np.float64]

LOOK_ALIKE = 0.95  # correlation from which on two parameters are not separated
FAR = 2.0  # mean NIS per measurement beyond which a covariance is said not to hold


@dataclass(frozen=True)
class LearnedParameter:
    """One parameter after the drive."""

    name: str
    unit: str
    value: float
    std: float
    prior: float
    prior_std: float

    @property
    def identified(self) -> bool:
        """Whether the drive determines it better than the prior."""
        return self.std**2 <= UNIDENTIFIABLE_RATIO * self.prior_std**2


@dataclass(frozen=True)
class DynamicsScore:
    """How the second half of the predictions over one horizon came out."""

    horizon: float  # s
    windows: int
    names: tuple[str, ...]  # of the measured states
    error: tuple[float, ...]  # root mean square, in the units of the states
    given_error: tuple[float, ...]  # the same with the parameters as they were given
    nis: float  # mean per measured state; 1 where the inflated covariance is true
    inflation: float  # of the variances over this horizon, as all errors show it

    @property
    def ratio(self) -> float:
        """Geometric mean over the measured states of error over that of the given parameters."""
        return float(np.exp(np.mean(np.log(np.array(self.error) / np.array(self.given_error)))))


@dataclass(frozen=True, eq=False)
class DynamicsPath:
    """A predicted path."""

    t: Floats  # [N] s from now
    states: Floats  # [N, states]
    covariance: Floats  # [N, states, states]


@dataclass(frozen=True, eq=False)
class LearnedDynamics:
    """The result of `learn_dynamics`."""

    dynamics: Dynamics
    estimate: _core.Estimate  # of the parameters, with a covariance that holds where noise is correlated, too
    state: _core.Estimate  # at the end of the drive
    seconds: float
    measurements: int
    rejected: int  # measurements that were far beyond their noise
    left_out: int  # rows that could not be used
    course: Floats  # [M, 1 + 2 parameters] t, parameters, their deviations as the filter knew them
    scores: tuple[DynamicsScore, ...]  # held out, one a horizon

    @property
    def parameters(self) -> tuple[LearnedParameter, ...]:
        """The parameters, in the order of the dynamics."""
        std = np.sqrt(np.diag(self.estimate.covariance))
        return tuple(
            LearnedParameter(p.name, p.unit, float(value), float(deviation), p.value, p.std)
            for p, value, deviation in zip(self.dynamics.parameters, self.estimate.mean, std, strict=True)
        )

    def __getitem__(self, name: str) -> LearnedParameter:
        """Return a parameter by its name; KeyError where there is none."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)

    @property
    def confounded(self) -> tuple[tuple[str, str, float], ...]:
        """Pairs of parameters that the drive can hardly tell apart, with their correlation."""
        names = [p.name for p in self.dynamics.parameters]
        pairs = _core.correlated_pairs(self.estimate.covariance, LOOK_ALIKE)
        return tuple((names[p.first], names[p.second], float(p.correlation)) for p in pairs)

    @property
    def good(self) -> bool:
        """Whether held-out predictions are better than with the parameters as they were given."""
        return bool(self.scores) and self.scores[-1].ratio < 1.0

    @property
    def verdict(self) -> str:
        """Whether to use it, in words."""
        sentences = [self._judgement()]
        unknown = [p.name for p in self.parameters if not p.identified]
        if unknown:
            sentences.append(f"The drive does not determine {', '.join(unknown)}: do not use the values.")
        for first, second, correlation in self.confounded:
            sentences.append(f"{first} and {second} can hardly be distinguished ({correlation:+.2f}).")
        if self.rejected > 0.05 * self.measurements:
            share = 100.0 * self.rejected / self.measurements
            sentences.append(
                f"{share:.0f} % of the measurements were rejected: check units, angles and stamps."
            )
        far = [score for score in self.scores if score.nis > FAR]
        if far:
            sentences.append(
                f"Errors after {far[-1].horizon:g} s are larger than their covariance says "
                f"(NIS {far[-1].nis:.1f} per measurement, 1 expected): allow more noise, or add what is "
                "missing."
            )
        return " ".join(sentences)

    def _judgement(self) -> str:
        if not self.scores:
            return "The drive is too short to judge predictions."
        last = self.scores[-1]
        compared = "less" if last.ratio < 1.0 else "no less"
        return (
            f"After {last.horizon:g} s held-out predictions miss by {number_text(last.ratio)} of what the "
            f"given parameters miss by: {compared}."
        )

    def predict(
        self, inputs: ArrayLike, times: Sequence[float], *, state: ArrayLike | None = None
    ) -> DynamicsPath:
        """Predict from a state, by default that at the end of the drive.

        Args:
            inputs: [N, 1 + inputs] rows of t [s] from now and inputs, the first at 0 or before.
            times: [M] s from now, rising.
            state: [states] now, taken to be known.

        Raises:
            SettingsError: a shape does not fit, a number is not finite, or the dynamics run away.
        """
        rows = np.asarray(inputs, dtype=np.float64)
        states = len(self.dynamics.states)
        if rows.ndim != 2 or rows.shape[1] != 1 + len(self.dynamics.inputs) or len(rows) == 0:
            raise SettingsError(
                f"the inputs have shape {rows.shape}",
                advice=f"give rows of {1 + len(self.dynamics.inputs)} numbers, t [s] first",
            )
        mean, spread = self.state.mean, self.state.covariance
        if state is not None:
            mean, spread = np.asarray(state, dtype=np.float64), np.zeros((states, states))
        if mean.shape != (states,):
            raise SettingsError(f"a state of shape {mean.shape}", advice=f"give {states} numbers")
        size = states + len(self.dynamics.parameters)
        covariance = np.zeros((size, size))
        covariance[:states, :states], covariance[states:, states:] = spread, self.estimate.covariance
        try:
            ahead = self.dynamics.filter_from(0.0, np.concatenate((mean, self.estimate.mean)), covariance)
            found = ahead.predict([float(t) for t in times], rows[:, 0], rows[:, 1:])
        except (ValueError, RuntimeError) as problem:
            raise SettingsError(str(problem), where="predict") from problem
        return DynamicsPath(
            np.array([at.t for at in found]),
            np.array([at.state for at in found]).reshape(-1, states),
            np.array([at.covariance for at in found]).reshape(-1, states, states),
        )

    def save(self, path: str | Path) -> Path:
        """Write a YAML file with values, deviations, covariance and verdict; return its path.

        Raises:
            OutputError: it cannot be written.
            SettingsError: this is no path.
        """
        check_arguments(LearnedDynamics.save, locals())
        from slipwise.dynamics.saved_dynamics import save_dynamics

        return save_dynamics(self, Path(path))

    def __str__(self) -> str:
        """A table of the parameters, one of held-out errors, and the verdict."""
        width = max(len(p.name) for p in self.parameters)
        lines = [f"{'parameter':{max(width, 9)}}       value        std      prior  identified"]
        lines += [
            f"{p.name:{max(width, 9)}}  {p.value:10.4g} {p.std:10.2g} {p.prior:10.4g}  "
            f"{'yes' if p.identified else 'no'}{f'  [{p.unit}]' if p.unit else ''}"
            for p in self.parameters
        ]
        for score in self.scores:
            each = ", ".join(
                f"{name} {number_text(error)} ({number_text(given)})"
                for name, error, given in zip(score.names, score.error, score.given_error, strict=True)
            )
            lines.append(f"after {score.horizon:g} s, {score.windows} windows, error (as given): {each}")
        return "\n".join([*lines, self.verdict])

    def __repr__(self) -> str:
        known = sum(p.identified for p in self.parameters)
        return f"<LearnedDynamics: {known} of {len(self.parameters)} parameters identified>"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return f"<pre>{escape(str(self))}</pre>"
