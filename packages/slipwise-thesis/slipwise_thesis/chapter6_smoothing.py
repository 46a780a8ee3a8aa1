# SPDX-License-Identifier: Apache-2.0
"""Slowly varying parameters, filtered as they come and smoothed afterwards: an addition to figure 6.4."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from slipwise import _core
from slipwise.number_text import number_text
from slipwise_sim import thesis_drive
from slipwise_thesis.panel import BASELINE, FITTED, INK, Band, Floats, Line, Panel
from slipwise_thesis.thesis_figure import ThesisFigure

BASIS = _core.named_basis("edd-2")
TRUTH = (-0.06, -0.35)  # mean of the two parameters [1], forward and angular
SWING = (0.03, 0.15)  # by which they change and come back
PRIOR_STD = (0.1, 0.3)
WINDOW = 5.0  # s
LENGTH = 1000.0  # m over which the random walk adds the prior's variance
NOISE = _core.MotionNoise([4e-4, 4e-4, 1e-4], [0.0] * 3, [0.0] * 3, 0.01, 0.003)
NAMES = ("forward slip per V [1]", "angular slip per ω [1]")


@dataclass(frozen=True, eq=False)
class Drifting:
    """A drive over terrain that changes, in W windows, and the posterior of its P parameters."""

    t: Floats  # [W] s, middle of the windows
    truth: Floats  # [W, P]
    filtered: tuple[Floats, Floats]  # mean and standard deviation [W, P], given the windows so far
    smoothed: tuple[Floats, Floats]  # given all


def smoothing_figure(seed: int, duration: float) -> ThesisFigure:
    """Compare the filter and the Rauch-Tung-Striebel smoother."""
    found = drifting_drive(seed, duration)
    errors = [
        np.sqrt(np.mean(np.square(mean - found.truth), axis=0))
        for mean, _ in (found.filtered, found.smoothed)
    ]
    inside = [
        100.0 * np.mean(np.abs(mean - found.truth) <= std) for mean, std in (found.filtered, found.smoothed)
    ]
    return ThesisFigure(
        key="smoothing",
        thesis="Beside Figure 6.4",
        title="Parameters that change slowly: filtered and smoothed",
        shows="Two slip parameters of a drive whose terrain changes and comes back, known from the windows "
        "so far (filter) and from all windows (smoother), each with one standard deviation.",
        agrees="As in (6.13), process noise lets the parameters follow the terrain: the filter follows with "
        f"{number_text(errors[0][0], 2)} and {number_text(errors[0][1], 2)} rms error.",
        differs="The thesis filters only. Afterwards, the smoother knows both sides of every moment: "
        f"{number_text(errors[1][0], 2)} and {number_text(errors[1][1], 2)} rms, without the filter's "
        f"lateness. Within one reported standard deviation lie {inside[0]:.0f} % (filter) and "
        f"{inside[1]:.0f} % (smoother) of the true values; 68 % would be exact for a random walk, "
        "which a sine is not.",
        source=f"windows of {WINDOW:g} s simulated with known slip noise and pose noise, {duration:g} s",
        parts=tuple(_panel(found, parameter) for parameter in range(len(NAMES))),
    )


def drifting_drive(seed: int, duration: float) -> Drifting:
    """Simulate windows whose slip parameters go through one sine, and learn them."""
    commands = thesis_drive(seed, duration)
    history = _core.InputHistory(commands.t, commands.v, commands.vy, commands.omega)
    model = _core.MotionModel(BASIS, False, False)
    starts = np.arange(0.0, duration - WINDOW + 1e-9, WINDOW)
    phase = np.sin(2.0 * math.pi * (starts + WINDOW / 2) / duration)
    truth = np.array(TRUTH) + phase[:, None] * np.array(SWING)
    random = np.random.Generator(np.random.PCG64([seed, 64]))
    segments, noises = [], []
    for start, alpha in zip(starts.tolist(), truth, strict=True):
        segment, noise = _measured(model, alpha, history, start, random)
        segments.append(segment)
        noises.append(noise)
    prior = _core.Estimate(np.zeros(2), np.asfortranarray(np.diag(np.square(PRIOR_STD))))
    return Drifting(starts + WINDOW / 2, truth, *_learned(model, prior, history, segments, noises))


def _measured(
    model: _core.MotionModel,
    alpha: Floats,
    history: _core.InputHistory,
    start: float,
    random: np.random.Generator,
) -> tuple[_core.Segment, Floats]:
    """One window as it is measured, and the covariance of its noise."""
    still = _core.Segment(start, start + WINDOW, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    path = _core.integrate_segment(model, alpha, history, still, _core.Integrator.Exact)
    end = np.array(path.poses[-1])
    noise = np.array(_core.slip_covariance(path, NOISE)) + np.array(
        _core.pose_noise_covariance(_core.Pose2(*end.tolist()), NOISE)
    )
    seen = end + np.linalg.cholesky(noise) @ random.standard_normal(3)
    segment = _core.Segment(start, start + WINDOW, _core.Pose2(*seen.tolist()), None, 0.0, 0.0)
    return segment, np.asfortranarray(noise)


def _learned(
    model: _core.MotionModel,
    prior: _core.Estimate,
    history: _core.InputHistory,
    segments: list[_core.Segment],
    noises: list[Floats],
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Filtered and smoothed means and standard deviations; the last smoothed one is the filtered one."""
    drift = _core.DriftSettings()
    drift.drift, drift.length = _core.Drift.RandomWalk, LENGTH
    iekf = _core.IekfSettings()

    def smoothed(count: int) -> list[_core.Estimate]:
        return _core.rts_smooth(
            model, prior, [history] * count, segments[:count], noises[:count], drift, iekf
        )

    filtered = [smoothed(count)[-1] for count in range(1, len(segments) + 1)]
    return _columns(filtered), _columns(smoothed(len(segments)))


def _columns(estimates: list[_core.Estimate]) -> tuple[Floats, Floats]:
    mean = np.array([estimate.mean for estimate in estimates])
    return mean, np.sqrt([np.diag(estimate.covariance) for estimate in estimates])


def _panel(found: Drifting, parameter: int) -> Panel:
    series: list[Band | Line] = []
    for name, colour, (mean, std) in (
        ("filter", BASELINE, found.filtered),
        ("smoother", FITTED, found.smoothed),
    ):
        m, s = mean[:, parameter], std[:, parameter]
        series += [Band(found.t, m - s, m + s, colour=colour), Line(found.t, m, name, colour)]
    series.append(Line(found.t, found.truth[:, parameter], "truth", INK, "dash"))
    return Panel(NAMES[parameter], "time [s]", NAMES[parameter], tuple(series))
