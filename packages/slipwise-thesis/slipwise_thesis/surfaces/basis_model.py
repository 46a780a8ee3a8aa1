# SPDX-License-Identifier: Apache-2.0
"""Slip surfaces as motion models that predict: linear ones exactly, a Gaussian process projected."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.models.model import Model
from slipwise.models.schema import (
    LARGEST,
    SCHEMA_VERSION,
    ModelFile,
    Noise,
    Parameter,
    Provenance,
    Range,
    Slip,
    VerdictSection,
)
from slipwise_thesis.surfaces.basis_slip import (
    BasisSlip,
    block_covariance,
    channel_designs,
    channel_slices,
    scaled_svd,
)
from slipwise_thesis.surfaces.bayesian import BayesianSurface
from slipwise_thesis.surfaces.examples import SlipExamples
from slipwise_thesis.surfaces.gaussian_process import GaussianProcessSurface
from slipwise_thesis.surfaces.least_squares import LeastSquaresSurface

Floats = NDArray[np.float64]

_NODES = 21  # along speed and yaw rate
_DETERMINED = 0.5  # of the prior variance; more is left: not determined
_UNITS = ("m/s", "m/s", "rad/s")


@dataclass(frozen=True)
class SegmentInfo:
    """What the examples' segments were."""

    seconds: float = 3.0  # length of a segment [s]
    input: Literal["command", "wheel"] = "command"  # what V and omega of the examples are


def as_basis_model(
    surface: LeastSquaresSurface | BayesianSurface | BasisSlip,
    examples: SlipExamples,
    *,
    segments: SegmentInfo = SegmentInfo(),
) -> Model:
    """Return a motion model whose slip is the surface, without lag, delay or clock offset.

    The noise of one segment's slip rates becomes white slip noise, whose mean over T seconds has the
    variance q/T. What a projection misses is added to that noise.

    Args:
        surface: a linear surface, or what `project_on_basis` made of another.
        examples: those it was learned from; they give the model its range.
        segments: how long their segments were, and of which input.

    Raises:
        SettingsError: the surface has learned nothing, or its examples do not determine it.
    """
    slip = surface if isinstance(surface, BasisSlip) else surface.basis_slip()
    std = np.sqrt(np.diag(slip.covariance))
    prior = np.minimum(slip.prior_std, LARGEST)
    motion = _core.MotionModel(slip.basis, False, False)
    parameters = [
        Parameter(
            name=info.name,
            stage="slip",
            unit=info.unit,
            value=value,
            std=sigma,
            prior_std=before,
            identifiable=bool((sigma / before) ** 2 < _DETERMINED),
        )
        for info, value, sigma, before in zip(
            motion.parameters, slip.alpha.tolist(), std.tolist(), prior.tolist(), strict=True
        )
    ]
    basis = slip.basis
    return Model(
        ModelFile(
            slipwise_model=SCHEMA_VERSION,
            input=segments.input,
            slip=Slip(basis=basis.name, lon=basis.lon, lat=basis.lat, ang=basis.ang),
            dynamics=False,
            clock_offset=False,
            parameters=parameters,
            covariance=slip.covariance.tolist(),
            noise=_noise(slip, segments.seconds),
            range=Range(
                speed=[float(examples.v.min()), float(examples.v.max())],
                yaw_rate=[float(examples.omega.min()), float(examples.omega.max())],
                slope=0.0,
            ),
            provenance=_provenance(len(examples), segments.seconds),
            verdict=_verdict(slip),
        )
    )


def project_on_basis(
    surface: GaussianProcessSurface, basis: _core.Basis, *, prior_std: Floats | None = None
) -> BasisSlip:
    """Fit the terms of a basis to the mean of a Gaussian process over the range of its examples.

    The projection is least squares over a grid of speeds and yaw rates. It carries the covariance of the
    process's mean over to the parameters, and states what it misses: root mean square and largest
    difference. A basis has no slip at rest, so the projection also takes out what the process has there.

    Args:
        surface: fitted.
        basis: its terms.
        prior_std: of the parameters, [p]; what the range of the examples does not determine keeps it.

    Raises:
        SettingsError: the examples lie at one speed or one yaw rate that leaves terms apart by nothing, and
            there is no prior.
    """
    (slow, fast), (right, left) = surface.range
    v, omega = (
        axis.ravel()
        for axis in np.meshgrid(np.linspace(slow, fast, _NODES), np.linspace(right, left, _NODES))
    )
    mean, joint = surface.predict(v, omega).mean, surface.mean_covariance(v, omega)
    alpha, blocks, missed = [], [], []
    designs = channel_designs(basis, v, omega)
    for channel, (design, part) in enumerate(zip(designs, channel_slices(basis), strict=True)):
        if prior_std is None and np.linalg.matrix_rank(design) < design.shape[1]:
            raise SettingsError(
                f"the range of the examples does not determine the terms of {basis.name}",
                advice="drive at more speeds and curvatures, or project on fewer terms",
            )
        inverse, rest = scaled_svd(design, np.ones(design.shape[1]) if prior_std is None else prior_std[part])
        alpha.append(inverse @ mean[:, channel])
        blocks.append(inverse @ joint[channel] @ inverse.T + rest)
        missed.append(mean[:, channel] - design @ alpha[-1])
    difference = np.column_stack(missed)
    return BasisSlip(
        basis,
        np.concatenate(alpha),
        block_covariance(basis, [0.5 * (block + block.T) for block in blocks]),
        np.full(basis.size, np.inf) if prior_std is None else prior_std,
        surface.noise_std,
        np.sqrt(np.mean(np.square(difference), axis=0)),
        np.abs(difference).max(axis=0),
    )


def _noise(slip: BasisSlip, seconds: float) -> Noise:
    variance = np.square(slip.noise_std) + np.square(slip.projection_rms)
    nothing = [0.0, 0.0, 0.0]
    return Noise(
        psd_time=(variance * seconds).tolist(),
        psd_motion=nothing,
        fraction=nothing,
        pose_std_xy=0.0,
        pose_std_yaw=0.0,
        variance_scale=[1.0, 1.0, 1.0],
    )


def _provenance(count: int, seconds: float) -> Provenance:
    return Provenance(
        slipwise_version=version("slipwise"),
        logs=[],
        settings={"learned_from": "slip rates of segments"},
        learned_seconds=count * seconds,
        learned_segments=count,
    )


def _verdict(slip: BasisSlip) -> VerdictSection:
    said = "The slip surface was fitted to slip rates of segments; no held-out prediction judged the model."
    if slip.projection_largest.any():
        missed = ", ".join(
            f"{rms:.2g} (at most {most:.2g}) {unit}"
            for rms, most, unit in zip(slip.projection_rms, slip.projection_largest, _UNITS, strict=True)
        )
        said += f" Its basis misses the surface by {missed}."
    return VerdictSection(good=False, sentence=said)
