# SPDX-License-Identifier: Apache-2.0
"""One pass over a recorded drive: parameters are learned, and the future is predicted before it is seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.dynamics.dynamics import Dynamics
from slipwise.dynamics.learned_dynamics import DynamicsScore, LearnedDynamics
from slipwise.errors import LogError, SettingsError

Floats = NDArray[np.float64]
Progress = Callable[[float], None]

NOTHING_LEARNED = 1e-12  # of the prior variances: parameters as they were given
PRIOR_WINDOWS = 5.0  # as many windows the stated covariance counts for before errors are seen
FEWEST = 10  # measurements from which anything is learned


def learn_dynamics(
    dynamics: Dynamics,
    inputs: ArrayLike,
    measurements: ArrayLike,
    *,
    horizons: Sequence[float] = (1.0, 2.0, 5.0),
    progress: Progress | None = None,
) -> LearnedDynamics:
    """Learn the parameters of `dynamics` from one drive.

    The filter is an iterated extended Kalman filter of state and parameters; between measurements the state
    is integrated with its derivatives (derivations/slopes-and-forces.md). Predictions are made from what was
    known before them, beside those of the parameters as they were given.

    Args:
        dynamics: what moves, and what is to be learned.
        inputs: [N, 1 + inputs] rows of t [s] and inputs, each held until the next.
        measurements: [M, 1 + measured states] rows of t [s] and measured states.
        horizons: over which predictions are judged [s].
        progress: called with the fraction done, 0 to 1.

    Raises:
        LogError: a table has another shape, or holds too little.
        SettingsError: a horizon is not positive, or the dynamics run away.
    """
    if not horizons or any(not (np.isfinite(h) and h > 0.0) for h in horizons):
        raise SettingsError("horizons must be positive seconds", where="horizons", advice="such as (1, 2, 5)")
    drive = recorded(dynamics, inputs, measurements)
    learner, given = _Pass(dynamics, drive, learning=True), _Pass(dynamics, drive, learning=False)
    made: dict[float, list[HeldOut]] = {horizon: [] for horizon in horizons}
    free = dict.fromkeys(horizons, -np.inf)  # s, until when the last prediction goes
    try:
        for k in range(1, len(drive.t)):
            learner.learn(k)
            given.learn(k)
            for horizon in horizons:
                target = int(np.searchsorted(drive.t, drive.t[k] + horizon - 1e-9))
                if drive.t[k] < free[horizon] or target >= len(drive.t):
                    continue
                made[horizon].append(HeldOut(k, target, learner.predict(k, target), given.predict(k, target)))
                free[horizon] = float(drive.t[target])
            if progress is not None:
                progress((k + 1) / len(drive.t))
    except (ValueError, RuntimeError) as problem:
        raise SettingsError(str(problem), where="dynamics") from problem
    return LearnedDynamics(
        dynamics=dynamics,
        estimate=learner.filter.reported_parameters,
        state=learner.filter.state,
        seconds=float(drive.t[-1] - drive.t[0]),
        measurements=len(drive.t),
        rejected=learner.rejected,
        left_out=drive.left_out,
        course=np.array(learner.course),
        scores=judged(dynamics, drive, made),
    )


class _Pass:
    """A filter on its way through a drive."""

    def __init__(self, dynamics: Dynamics, drive: Recorded, *, learning: bool) -> None:
        self._drive, self._pushed = drive, 0
        self.rejected = 0
        self.course: list[Floats] = []  # rows of t, parameters, deviations
        states = dynamics.states
        first = dict(zip(dynamics.measured, drive.measured[0].tolist(), strict=True))
        mean = [first.get(place, state.start) for place, state in enumerate(states)]
        std = [state.start_std if state.measured is None else state.measured for state in states]
        share = 1.0 if learning else NOTHING_LEARNED
        variances = [s**2 for s in std] + [share * p.std**2 for p in dynamics.parameters]
        start = np.array(mean + [p.value for p in dynamics.parameters], dtype=np.float64)
        self.filter = dynamics.filter_from(float(drive.t[0]), start, np.diag(variances))

    def learn(self, k: int) -> None:
        """Push inputs up to measurement `k`, and that measurement."""
        drive = self._drive
        while self._pushed < len(drive.input_t) and drive.input_t[self._pushed] < drive.t[k]:
            self.filter.push_input(float(drive.input_t[self._pushed]), drive.inputs[self._pushed])
            self._pushed += 1
        update = self.filter.push_measurement(float(drive.t[k]), drive.measured[k])
        self.rejected += update.status == _core.Status.Rejected
        known = self.filter.parameters
        self.course.append(np.array([drive.t[k], *known.mean, *np.sqrt(np.diag(known.covariance))]))

    def predict(self, k: int, target: int) -> _core.DynamicsPrediction:
        """Predict the state at measurement `target` from the estimate at `k`, under the inputs recorded."""
        drive = self._drive
        first = max(0, int(np.searchsorted(drive.input_t, drive.t[k] + 1e-9)) - 1)
        last = int(np.searchsorted(drive.input_t, drive.t[target]))
        part = slice(first, max(last, first + 1))
        return self.filter.predict([float(drive.t[target])], drive.input_t[part], drive.inputs[part])[0]


@dataclass(frozen=True)
class HeldOut:
    """From measurement `start` to measurement `end`, as learned and as given parameters foresaw it."""

    start: int
    end: int
    learned: _core.DynamicsPrediction
    given: _core.DynamicsPrediction


def judged(
    dynamics: Dynamics, drive: Recorded, made: Mapping[float, Sequence[HeldOut]]
) -> tuple[DynamicsScore, ...]:
    """Score the second half of the predictions of each horizon; horizons without two are left out."""
    return tuple(_score(dynamics, drive, h, rows) for h, rows in made.items() if len(rows) >= 2)


def _score(dynamics: Dynamics, drive: Recorded, horizon: float, rows: Sequence[HeldOut]) -> DynamicsScore:
    learned = np.array([_error(dynamics, drive, row.end, row.learned) for row in rows])
    given = np.array([_error(dynamics, drive, row.end, row.given) for row in rows])
    squared = np.array(
        [_squared(dynamics, error, row.learned) for error, row in zip(learned, rows, strict=True)]
    )
    size = learned.shape[1]
    # Each prediction is inflated by the errors of those that ended before it began.
    ends, starts = drive.t[[row.end for row in rows]], drive.t[[row.start for row in rows]]
    before = np.searchsorted(ends, starts, side="right")
    sums = np.concatenate(([0.0], np.cumsum(squared / size)))
    inflation = (PRIOR_WINDOWS + sums[before]) / (PRIOR_WINDOWS + before)
    half = slice(len(rows) // 2, None)
    return DynamicsScore(
        horizon=horizon,
        windows=len(rows) - len(rows) // 2,
        names=dynamics.measured_names,
        error=tuple(np.sqrt((learned[half] ** 2).mean(axis=0)).tolist()),
        given_error=tuple(np.sqrt((given[half] ** 2).mean(axis=0)).tolist()),
        nis=float((squared / inflation)[half].mean() / size),
        inflation=float((PRIOR_WINDOWS + sums[-1]) / (PRIOR_WINDOWS + len(rows))),
    )


def _error(dynamics: Dynamics, drive: Recorded, end: int, predicted: _core.DynamicsPrediction) -> Floats:
    """Measured minus predicted, [measured states]; angles without whole turns."""
    difference = drive.measured[end] - predicted.state[list(dynamics.measured)]
    angle = np.array([dynamics.states[place].angle for place in dynamics.measured])
    turned = np.arctan2(np.sin(difference), np.cos(difference))
    return np.asarray(np.where(angle, turned, difference), dtype=np.float64)


def _squared(dynamics: Dynamics, error: Floats, predicted: _core.DynamicsPrediction) -> float:
    """The squared error in its covariance, the measurement's noise included."""
    places = list(dynamics.measured)
    noise = np.diag([(dynamics.states[place].measured or 0.0) ** 2 for place in places])
    covariance = predicted.covariance[np.ix_(places, places)] + noise
    return float(error @ np.linalg.solve(covariance, error))


@dataclass(frozen=True, eq=False)
class Recorded:
    """One drive."""

    input_t: Floats  # [N] s, rising
    inputs: Floats  # [N, inputs], each held until the next
    t: Floats  # [M] s, rising
    measured: Floats  # [M, measured states]
    left_out: int  # rows that were not used: not finite, not later than the row before, or before any input


def recorded(dynamics: Dynamics, inputs: ArrayLike, measurements: ArrayLike) -> Recorded:
    """Return what was recorded in the order of time.

    Args:
        dynamics: whose inputs and measured states the columns are.
        inputs: [N, 1 + inputs] rows of t [s] and inputs.
        measurements: [M, 1 + measured states] rows of t [s] and measured states.

    Raises:
        LogError: a table has another shape, or there are fewer than ten measurements.
    """
    given, given_out = _table("inputs", inputs, 1 + len(dynamics.inputs))
    seen, seen_out = _table("measurements", measurements, 1 + len(dynamics.measured))
    if len(given):
        early = seen[:, 0] < given[0, 0]
        seen, seen_out = seen[~early], seen_out + int(early.sum())
    if len(given) == 0 or len(seen) < FEWEST:
        raise LogError(
            f"there are {len(given)} inputs and {len(seen)} measurements after the first of them",
            advice=f"it takes {FEWEST} measurements at least; stamps of both must be of one clock",
        )
    return Recorded(given[:, 0], given[:, 1:], seen[:, 0], seen[:, 1:], given_out + seen_out)


def _table(name: str, rows: ArrayLike, columns: int) -> tuple[Floats, int]:
    """Return finite rows in rising order of their stamps, and how many were left out."""
    try:
        table = np.asarray(rows, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise LogError(f"the {name} are no table of numbers") from problem
    if table.ndim != 2 or table.shape[1] != columns:
        raise LogError(
            f"the {name} have shape {table.shape}", advice=f"give rows of {columns} numbers, t [s] first"
        )
    table = table[np.isfinite(table).all(axis=1)]
    table = table[np.argsort(table[:, 0], kind="stable")]
    kept = table[np.diff(table[:, 0], prepend=-np.inf) > 0.0]
    return kept, len(np.asarray(rows)) - len(kept)
