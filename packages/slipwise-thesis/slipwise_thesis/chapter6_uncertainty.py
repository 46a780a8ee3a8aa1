# SPDX-License-Identifier: Apache-2.0
"""Figures 6.6 and 6.7: the final covariance as correlations, and the learned surfaces with uncertainty."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.number_text import number_text
from slipwise_thesis.chapter6_convergence import CHANNELS, TERMS
from slipwise_thesis.chapter6_recording import Recording
from slipwise_thesis.panel import Floats, Heat, Panel, Surface
from slipwise_thesis.thesis_figure import ThesisFigure

NODES = 21
SPEEDS, CURVATURES = (0.5, 2.0), (-0.5, 0.5)  # [m/s], [1/m] that the circles of the drive cover
UNITS = ("m/s", "m/s", "rad/s")


def correlation_figure(filtered: Recording, correct: Recording, source: str) -> ThesisFigure:
    """Make figure 6.6."""
    found, other = _correlation(filtered), _correlation(correct)
    within, across = _blocks(found)
    within_other, across_other = _blocks(other)
    names = tuple(f"α{place + 1},{symbol}" for symbol, _ in CHANNELS for place in range(len(TERMS)))
    return ThesisFigure(
        key="figure-6-6",
        thesis="Figure 6.6",
        title="Final uncertainty of the parameters",
        shows="Correlations of the 15 parameters after the drive: of the thesis's filter, and of the "
        "iterated filter on disjoint segments with the exact Jacobian.",
        agrees="Parameters of one slip rate are correlated, those of different slip rates hardly: mean "
        f"absolute correlations are {within:.2f} within and {across:.2f} between slip rates.",
        differs="With the exact Jacobian, in which yaw slip moves the robot, they are "
        f"{within_other:.2f} and {across_other:.2f}. The thesis's standard deviations are "
        f"{_ratio_text(filtered, correct)} times those of the iterated filter (median): each datum counts "
        "about a hundred times in its overlapping segments, but its measurement noise is given, and "
        f"{_noise_text(correct)} times what the iterated filter learns from the residuals (variances of x, y "
        "and heading).",
        source=source,
        parts=(
            Panel("thesis's filter, (6.7)", "", "", (Heat(found, names, names),)),
            Panel("iterated filter, exact Jacobian", "", "", (Heat(other, names, names),)),
        ),
    )


def learned_surface_figure(filtered: Recording, correct: Recording, source: str) -> ThesisFigure:
    """Make figure 6.7."""
    mean, std = surface_of(filtered)
    other, other_std = surface_of(correct)
    away = np.sqrt(np.mean(np.square(mean - other), axis=(1, 2)))
    size = np.sqrt(np.mean(np.square(mean), axis=(1, 2)))
    panels = tuple(
        Panel(
            name,
            "V [m/s]",
            "κ [1/m]",
            (Surface(*_axes(), mean[channel], std[channel]),),
            z_label=f"slip rate [{UNITS[channel]}]",
        )
        for channel, (_, name) in enumerate(CHANNELS)
    )
    return ThesisFigure(
        key="figure-6-7",
        thesis="Figure 6.7",
        title="Slip surfaces learned by the extended Kalman filter",
        shows="The surfaces after the drive, between sheets one standard deviation of the surface away.",
        agrees=f"The angular slip rate is the largest, {number_text(size[2], 2)} rad/s rms, beside "
        f"{number_text(size[0], 2)} m/s forward and {number_text(size[1], 2)} m/s sideways, and odd in the "
        "curvature, as the surfaces of chapter 5.",
        differs="The sheets are of the mean surface, without the noise of single segments. The iterated "
        f"filter on disjoint segments differs from it by {number_text(away[0], 2)}, "
        f"{number_text(away[1], 2)} m/s and {number_text(away[2], 2)} rad/s rms, "
        f"{_sigmas(mean - other, std)} of the thesis's standard deviations (median) and "
        f"{_sigmas(mean - other, other_std)} of its own.",
        source=source,
        parts=panels,
    )


def surface_of(recording: Recording) -> tuple[Floats, Floats]:
    """Mean and standard deviation of the slip rates over speed and curvature, [3, K, S] each."""
    speed, curvature = _axes()
    v, kappa = np.meshgrid(speed, curvature)
    basis, alpha = recording.motion.basis, recording.mean[-1][: recording.motion.slip_size]
    size = recording.motion.slip_size
    covariance = np.asfortranarray(recording.covariance[-1][:size, :size])
    states = [
        _core.SlipState(a, a * b, 0.0, 0.0)
        for a, b in zip(v.ravel().tolist(), kappa.ravel().tolist(), strict=True)
    ]
    mean = np.array([_core.slip_rate(basis, alpha, state) for state in states])
    variance = np.array([np.diag(_core.slip_rate_covariance(basis, covariance, state)) for state in states])
    shape = (3, NODES, NODES)
    return mean.T.reshape(shape), np.sqrt(variance).T.reshape(shape)


def _axes() -> tuple[Floats, Floats]:
    return np.linspace(*SPEEDS, NODES), np.linspace(*CURVATURES, NODES)


def _correlation(recording: Recording) -> Floats:
    size = recording.motion.slip_size
    covariance = recording.covariance[-1][:size, :size]
    per_unit = 1.0 / np.sqrt(np.diag(covariance))
    return np.asarray(covariance * np.outer(per_unit, per_unit), dtype=np.float64)


def _sigmas(difference: Floats, std: Floats) -> str:
    return number_text(float(np.median(np.abs(difference) / std)), 2)


def _blocks(correlation: Floats) -> tuple[float, float]:
    """Mean absolute correlation of different parameters within slip rates, and between them."""
    channel = np.arange(len(correlation)) // len(TERMS)
    same = channel[:, None] == channel[None, :]
    other = ~np.eye(len(correlation), dtype=bool)
    size = np.abs(correlation)
    return float(size[same & other].mean()), float(size[~same].mean())


def _ratio_text(filtered: Recording, correct: Recording) -> str:
    size = filtered.motion.slip_size
    return number_text(float(np.median(filtered.std[-1][:size] / correct.std[-1][:size])), 2)


def _noise_text(correct: Recording) -> str:
    return ", ".join(number_text(1.0 / scale, 2) for scale in correct.noise_scale[-1].tolist())
