# SPDX-License-Identifier: Apache-2.0
"""The steady state of thesis chapter 4: held commands, their slip rates, and how these scatter."""

from slipwise_thesis.steady.draws import DrawnPaths, DrawRules, draw_paths
from slipwise_thesis.steady.groups import GroupRules, SteadyGroup, group_paths
from slipwise_thesis.steady.holds import Hold, HoldRules, find_holds
from slipwise_thesis.steady.noise import GroupNoise, NoiseRules, fit_group_noise, scatter_group
from slipwise_thesis.steady.paths import PathRules, SteadyPath, SteadyPaths, cut_paths
from slipwise_thesis.steady.slip_fit import (
    CurveResidual,
    FitComparison,
    SlipFitRules,
    compare_fits,
    fit_slip,
    slip_path,
    slipped_twist,
)
from slipwise_thesis.steady.slip_table import SlipRow, slip_table

__all__ = [
    "CurveResidual",
    "DrawRules",
    "DrawnPaths",
    "FitComparison",
    "GroupNoise",
    "GroupRules",
    "Hold",
    "HoldRules",
    "NoiseRules",
    "PathRules",
    "SlipFitRules",
    "SlipRow",
    "SteadyGroup",
    "SteadyPath",
    "SteadyPaths",
    "compare_fits",
    "cut_paths",
    "draw_paths",
    "find_holds",
    "fit_group_noise",
    "fit_slip",
    "group_paths",
    "scatter_group",
    "slip_path",
    "slip_table",
    "slipped_twist",
]
