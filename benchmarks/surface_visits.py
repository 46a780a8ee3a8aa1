# SPDX-License-Identifier: Apache-2.0
"""Random visits to simulated surfaces: which one was recognised, and what labels are worth.

A robot with wheel input visits five surfaces at random, two of which are alike. Which
surface is right is told by names: one means the surface that most visits of that name were to, and a
surface has one name. The oracle knows all surfaces and the law of the noise, and asks which is likeliest.
Labels of these visits are right, or wrong for 30 % of them.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from simulated_log import POSE_STD_XY, POSE_STD_YAW, RATE, SLIP, simulated_log
from terrain_change import COLOUR_SECONDS, SLIP_PSD, SLIP_STD, coloured, white

from slipwise.calibration.learned_sequence import LearnedSequence, SequenceOptions, learn_sequence
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings import Settings

Floats = NDArray[np.float64]

FIRST = 10  # windows of a visit
LEVELS = (0.5, 0.9, 0.95)
SIMULATED_HORIZON = 2.0  # s
POSE_STD = np.array([POSE_STD_XY, POSE_STD_XY, POSE_STD_YAW])  # m, m, rad
NOISES = {"white": white, "coloured": coloured}
#: lon V, lat w and ang w of each surface; the last is like the first.
SIMULATED = (
    (-0.05, 0.06, -0.35),
    (-0.15, 0.03, -0.20),
    (-0.02, 0.0, -0.50),
    (-0.25, 0.10, -0.42),
    (-0.051, 0.06, -0.352),
)


def coverage(inside: Floats) -> tuple[float, float, float]:
    """Return the fractions within the ellipsoids of each level."""
    low, middle, high = ((inside < level).mean() for level in LEVELS)
    return float(low), float(middle), float(high)


@dataclass(frozen=True)
class SimulatedVisits:
    """What became of random visits to simulated surfaces."""

    noise: str
    visits: int
    right: float  # fraction of visits that ended on the right surface
    right_known: float  # the same of visits to surfaces that were driven before
    surfaces: int  # that are remembered in the end; 4, where the two that are alike are one
    inside: tuple[float, float, float]  # of all windows
    inside_first: tuple[float, float, float]  # of the first ten of each visit but the first


def slip_of(surface: tuple[float, float, float]) -> Floats:
    """Return the parameters of a surface."""
    slip = SLIP.copy()
    slip[0], slip[3], slip[6] = surface
    return slip


def simulated_visits(noise: str, visits: int, minutes: float, seed: int) -> SimulatedVisits:
    """Drive on random surfaces in turn."""
    rng = np.random.default_rng(seed)
    truth = rng.integers(len(SIMULATED), size=visits)
    logs = [
        simulated_log(minutes, seed=1000 * seed + i, slips=(slip_of(SIMULATED[k]),), slip_noise=NOISES[noise])
        for i, k in enumerate(truth)
    ]
    learned = learn_sequence([prepare_run(log, "wheel") for log in logs], Settings(), (SIMULATED_HORIZON,))
    _, right = right_surfaces(learned, truth)
    seen = np.array([k in set(truth[:i]) for i, k in enumerate(alike(truth))])
    inside = [log.predictions[0].inside for log in learned.logs]
    return SimulatedVisits(
        noise=noise,
        visits=visits,
        right=float(right.mean()),
        right_known=float(right[seen].mean()),
        surfaces=len(learned.surfaces),
        inside=coverage(np.concatenate(inside)),
        inside_first=coverage(np.concatenate([each[:FIRST] for each in inside[1:]])),
    )


def oracle_right(noise: str, visits: int, minutes: float, seed: int) -> float:
    """Return how often one who knows all surfaces and the noise finds the right one at a visit's end.

    Mean slip rates of each second are Gaussian about those of each surface, with the covariance of the noise
    and of the poses' differences; signs of the turns that were driven are those of the visit.
    """
    rng = np.random.default_rng(seed)
    truth = rng.integers(len(SIMULATED), size=visits)
    right = 0
    for i, k in enumerate(truth):
        log = simulated_log(minutes, seed=1000 * seed + i, slips=(slip_of(SIMULATED[k]),))
        wheels = log.runs[0].wheels
        assert wheels is not None
        rates = [second_means(np.column_stack(slip_rates(wheels.v, wheels.omega, s))) for s in SIMULATED]
        drawn = second_means(NOISES[noise](len(wheels.t), rng)) + pose_noise(len(rates[0]), rng)
        covariances = second_covariances(noise, len(rates[0]))
        scores = []
        for each in rates:
            left = rates[k] + drawn - each
            scores.append(-sum(left[:, c] @ np.linalg.solve(covariances[c], left[:, c]) for c in range(3)))
        right += alike(np.array([np.argmax(scores)]))[0] == alike(np.array([k]))[0]
    return right / visits


def slip_rates(
    v: Floats, omega: Floats, surface: tuple[float, float, float]
) -> tuple[Floats, Floats, Floats]:
    """Return the slip rates that surfaces differ by, forward, sideways and of the turn."""
    return surface[0] * v, surface[1] * omega, surface[2] * omega


def second_means(values: Floats) -> Floats:
    """Return means over each second, [seconds, columns]."""
    held = round(RATE)
    return np.asarray(values[: len(values) // held * held].reshape(-1, held, values.shape[1]).mean(axis=1))


def pose_noise(seconds: int, rng: np.random.Generator) -> Floats:
    """Return the differences, a second apart, of what poses are wrong by."""
    return np.asarray(np.diff(rng.standard_normal((seconds + 1, 3)) * POSE_STD, axis=0))


def second_covariances(noise: str, seconds: int) -> list[Floats]:
    """Return the covariance of the means of each second, by channel."""
    differences = 2.0 * np.eye(seconds) - np.eye(seconds, k=1) - np.eye(seconds, k=-1)
    if noise == "white":
        slip = [psd * np.eye(seconds) for psd in SLIP_PSD]
    else:
        apart = np.abs(np.subtract.outer(np.arange(seconds), np.arange(seconds)))
        slip = [std**2 * np.exp(-apart / COLOUR_SECONDS) for std in SLIP_STD]
    return [s + p**2 * differences for s, p in zip(slip, POSE_STD, strict=True)]


@dataclass(frozen=True)
class LabelledVisits:
    """Heading errors of visits with labels over those without, and how many labels were right."""

    noise: str
    wrong: float  # fraction of labels
    first: float  # of the first three windows of visits to surfaces that were driven before
    all: float  # of all windows of these
    reliability: float  # right labels of all that were judged


def labelled_visits(noise: str, visits: int, wrong: float, seed: int) -> LabelledVisits:
    """Drive on random surfaces in turn, some of them under a wrong name."""
    rng = np.random.default_rng(seed)
    truth = alike(rng.integers(len(SIMULATED), size=visits))
    named = np.where(rng.random(visits) < wrong, (truth + rng.integers(1, 4, visits)) % 4, truth)
    drives = [
        prepare_run(
            simulated_log(
                1.0, seed=1000 * seed + i, slips=(slip_of(SIMULATED[k]),), slip_noise=NOISES[noise]
            ),
            "wheel",
        )
        for i, k in enumerate(truth)
    ]
    labels = tuple(f"floor {k}" for k in named)
    alone = learn_sequence(drives, Settings(), (SIMULATED_HORIZON,))
    labelled = learn_sequence(
        drives, Settings(), (SIMULATED_HORIZON,), options=SequenceOptions(labels=labels)
    )
    known = [i for i, k in enumerate(truth) if k in set(truth[:i])]

    def heading(learned: LearnedSequence, count: int | None) -> float:
        return float(np.mean([learned.logs[i].predictions[0].heading_error[:count].mean() for i in known]))

    judged, right = labelled.labels
    return LabelledVisits(
        noise,
        wrong,
        heading(labelled, 3) / heading(alone, 3),
        heading(labelled, None) / heading(alone, None),
        right / max(judged, 1.0),
    )


def alike(truth: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the surfaces, the two that are alike as one."""
    return np.where(truth == len(SIMULATED) - 1, 0, truth)


def right_surfaces(
    learned: LearnedSequence, truth: NDArray[np.int64]
) -> tuple[dict[int, str], NDArray[np.bool_]]:
    """Return the name of each surface, what was merged under its last name, and which visits ended on it."""
    renamed: dict[str, str] = {}
    for log in learned.logs:
        renamed |= {change.other: change.name for change in log.changes if change.what == "merged"}

    def last(name: str) -> str:
        while name in renamed:
            name = renamed[name]
        return name

    called = [last(log.surface) for log in learned.logs]
    same = alike(truth)
    meant = {
        name: Counter(same[np.array(called) == name].tolist()).most_common(1)[0][0] for name in set(called)
    }
    visits = Counter(called)
    names = {}
    for name in sorted(
        meant, key=lambda each: -visits[each]
    ):  # of two names for one surface, the rarer is wrong
        names.setdefault(meant[name], name)
    right = np.array([names.get(int(k)) == name for name, k in zip(called, same, strict=True)])
    return names, right
