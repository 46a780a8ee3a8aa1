# SPDX-License-Identifier: Apache-2.0
"""Slip rate surfaces learned from the slip rates of segments (thesis chapter 5)."""

from slipwise_thesis.surfaces.basis_model import SegmentInfo, as_basis_model, project_on_basis
from slipwise_thesis.surfaces.basis_slip import BasisSlip
from slipwise_thesis.surfaces.bayesian import BayesianOptions, BayesianSurface
from slipwise_thesis.surfaces.examples import SlipExamples, slip_examples
from slipwise_thesis.surfaces.gaussian_process import GaussianProcessOptions, GaussianProcessSurface
from slipwise_thesis.surfaces.least_squares import LeastSquaresSurface
from slipwise_thesis.surfaces.scores import LEVELS, SurfaceScore, score_surface
from slipwise_thesis.surfaces.surface import SlipSurface, SurfacePrediction, UpdatableSurface

__all__ = [
    "LEVELS",
    "BasisSlip",
    "BayesianOptions",
    "BayesianSurface",
    "GaussianProcessOptions",
    "GaussianProcessSurface",
    "LeastSquaresSurface",
    "SegmentInfo",
    "SlipExamples",
    "SlipSurface",
    "SurfacePrediction",
    "SurfaceScore",
    "UpdatableSurface",
    "as_basis_model",
    "project_on_basis",
    "score_surface",
    "slip_examples",
]
