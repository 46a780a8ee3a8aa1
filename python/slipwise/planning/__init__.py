# SPDX-License-Identifier: Apache-2.0
"""Planning with a learned model: trajectories to a goal, routes through a map, and the MPPI controller."""

from slipwise.planning.grid_map import GridMap, load_map
from slipwise.planning.holdable import CurvatureMap, curvature_map
from slipwise.planning.lattice import LatticeOptions, Primitive, lattice_primitives, write_lattice
from slipwise.planning.limits import DriveState, Limits, limits_of
from slipwise.planning.mppi import (
    Controller,
    Motion,
    MppiOptions,
    costmap,
    learned_motions,
    plain_motion,
    vendor_motion,
)
from slipwise.planning.route import Route, RouteOptions, RoutePlanner
from slipwise.planning.track import Track
from slipwise.planning.trajectory import (
    Planner,
    Trajectory,
    TrajectoryOptions,
    trajectory_to,
    uncertain_path,
)

__all__ = [
    "Controller",
    "CurvatureMap",
    "DriveState",
    "GridMap",
    "LatticeOptions",
    "Limits",
    "Motion",
    "MppiOptions",
    "Planner",
    "Primitive",
    "Route",
    "RouteOptions",
    "RoutePlanner",
    "Track",
    "Trajectory",
    "TrajectoryOptions",
    "costmap",
    "curvature_map",
    "lattice_primitives",
    "learned_motions",
    "limits_of",
    "load_map",
    "plain_motion",
    "trajectory_to",
    "uncertain_path",
    "vendor_motion",
    "write_lattice",
]
