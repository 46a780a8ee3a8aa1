# SPDX-License-Identifier: Apache-2.0
"""For planners: rollouts, trajectories, routes, the MPPI controller and lattices, through a learned model."""

from slipwise.planning.costmap import Costmap
from slipwise.planning.futures import sample_futures
from slipwise.planning.grid_map import GridMap, load_map
from slipwise.planning.holdable import CurvatureMap, curvature_map
from slipwise.planning.lattice import LatticeOptions, Primitive, lattice_primitives, write_lattice
from slipwise.planning.limits import DriveState, Limits, limits_of
from slipwise.planning.mppi import (
    Controller,
    Motion,
    MppiOptions,
    baseline_motion,
    inflated,
    learned_motions,
    vendor_motion,
)
from slipwise.planning.reference_path import ReferencePath
from slipwise.planning.rollout import Rollouts, command_buffer, rollout
from slipwise.planning.route import Route, RouteOptions, RoutePlanner
from slipwise.planning.start import Start
from slipwise.planning.trajectory import (
    Planner,
    Trajectory,
    TrajectoryOptions,
    trajectory_to,
    uncertain_path,
)

__all__ = [
    "Controller",
    "Costmap",
    "CurvatureMap",
    "DriveState",
    "GridMap",
    "LatticeOptions",
    "Limits",
    "Motion",
    "MppiOptions",
    "Planner",
    "Primitive",
    "ReferencePath",
    "Rollouts",
    "Route",
    "RouteOptions",
    "RoutePlanner",
    "Start",
    "Trajectory",
    "TrajectoryOptions",
    "baseline_motion",
    "command_buffer",
    "curvature_map",
    "inflated",
    "lattice_primitives",
    "learned_motions",
    "limits_of",
    "load_map",
    "rollout",
    "sample_futures",
    "trajectory_to",
    "uncertain_path",
    "vendor_motion",
    "write_lattice",
]
