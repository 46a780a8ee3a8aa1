# SPDX-License-Identifier: Apache-2.0
"""Lattice primitives join grid points, bend no tighter than slip allows, and read as Nav2's."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from planning.planning_samples import LIMITS, learned_model, sliding
from sample_models import Made, make_model, named

from slipwise import _core
from slipwise.errors import PlanningError, SettingsError, UnseenSpeed
from slipwise.ground import Grade
from slipwise.planning import (
    LatticeOptions,
    Primitive,
    curvature_map,
    lattice_primitives,
    write_lattice,
)
from slipwise.planning.lattice import heading_angles

OPTIONS = LatticeOptions(speed=0.5, grid=0.2)


@pytest.fixture(scope="module")
def primitives() -> list[Primitive]:
    return lattice_primitives(learned_model(), options=OPTIONS, limits=LIMITS)


def fraction() -> float:
    """Return the fraction of a commanded curvature that this model's slip leaves."""
    values = {parameter.name: parameter.value for parameter in learned_model().content.parameters}
    return (1.0 + values["ang.w"]) / (1.0 + values["lon.V"])


def test_the_map_of_held_curvatures_has_dead_band_and_tops() -> None:
    axes = {"speed": {"saturation": 0.8}, "yaw_rate": {"dead_band": 0.1, "saturation": 0.5}}
    model = make_model(Made(basis=_core.Basis("none", [], [], []), commands=True, limits=axes))
    held = curvature_map(model, limits=LIMITS, speeds=3, curvatures=21)
    speed = np.broadcast_to(held.speed[:, None], held.held.shape)
    turn = held.commanded * speed
    known = np.isfinite(held.held)
    left = np.where(np.abs(turn) < 0.1, 0.0, np.clip(turn, -0.5, 0.5))
    assert held.held[known] == pytest.approx((left / np.minimum(speed, 0.8))[known])
    assert held.achieved_speed[known] == pytest.approx(np.minimum(speed, 0.8)[known])


def test_a_lattice_to_a_side_that_was_never_driven_is_warned_of() -> None:
    one_sided = make_model(replace(named("edd-2"), speed=(0.0, 1.0), yaw_rate=(0.0, 1.0)))
    with pytest.warns(UnseenSpeed, match="yaw rate of -.* rad/s is far beyond the 0 rad/s"):
        lattice_primitives(one_sided, options=replace(OPTIONS, turns=1), limits=LIMITS)


def test_on_a_slope_each_heading_has_primitives_of_its_own_that_end_on_the_grid() -> None:
    model, grade = sliding(), Grade(0.15, downhill=-math.pi / 2.0)
    made = lattice_primitives(model, options=replace(OPTIONS, turns=1), limits=LIMITS, grade=grade)
    assert {primitive.start for primitive in made} == set(range(16))
    ends = np.array([primitive.poses[-1, :2] for primitive in made]) / OPTIONS.grid
    assert ends == pytest.approx(np.round(ends), abs=1e-9)
    straight = {primitive.start: primitive.length for primitive in made if primitive.swing == 0.0}
    # Straight up and down one grid step will do; across, where the robot slides, an S has to make up for it.
    assert {heading for heading, length in straight.items() if length < 0.5} == {4, 12}
    assert min(straight[0], straight[8]) > 2.0


def test_headings_point_at_grid_points() -> None:
    angles = heading_angles(16)
    expected = [0.0, math.atan2(1, 2), math.pi / 4, math.atan2(2, 1), math.pi / 2]
    assert angles[:5] == pytest.approx(expected)
    assert (np.diff(angles) > 0.0).all()
    with pytest.raises(SettingsError, match="12 headings"):
        heading_angles(12)


def test_primitives_end_on_grid_points_at_lattice_headings(primitives: list[Primitive]) -> None:
    angles = heading_angles(OPTIONS.headings)
    for made in primitives:
        cells = made.poses[-1, :2] / OPTIONS.grid
        assert cells == pytest.approx(np.round(cells), abs=1e-9)
        off = (made.poses[-1, 2] - angles[made.end] + math.pi) % (2.0 * math.pi) - math.pi
        assert off == pytest.approx(0.0, abs=1e-9)
        assert made.swing == pytest.approx(math.remainder(angles[made.end] - angles[made.start], 2 * math.pi))


def test_every_heading_goes_straight_and_turns_to_both_sides(primitives: list[Primitive]) -> None:
    for start in range(OPTIONS.headings):
        swings = [made.swing for made in primitives if made.start == start]
        assert min(swings) < 0.0 < max(swings)
        assert 0.0 in swings


def test_no_primitive_bends_tighter_than_the_robot_can(primitives: list[Primitive]) -> None:
    held = curvature_map(learned_model(), limits=LIMITS, speeds=30)
    tightest = float(np.nanmax([np.nanmax(side) for side in held.tightest()]))
    assert tightest == pytest.approx(fraction() * LIMITS.curvature, rel=1e-6)
    for made in primitives:
        assert abs(made.swing) <= made.length * tightest * 1.02


def test_the_file_holds_what_nav2_reads(tmp_path: Path) -> None:
    path = write_lattice(tmp_path / "lattice.json", learned_model(), options=OPTIONS, limits=LIMITS)
    content = json.loads(path.read_text(encoding="utf-8"))
    metadata = content["lattice_metadata"]
    assert metadata["num_of_headings"] == len(metadata["heading_angles"]) == 16
    assert metadata["number_of_trajectories"] == len(content["primitives"])
    assert metadata["turning_radius"] == pytest.approx(1.0 / (fraction() * LIMITS.curvature), rel=1e-4)
    starts = [entry["start_angle_index"] for entry in content["primitives"]]
    assert starts == sorted(starts)  # Nav2 begins a new list where the start heading changes
    for entry in content["primitives"]:
        assert set(entry) == {
            "trajectory_id",
            "start_angle_index",
            "end_angle_index",
            "left_turn",
            "trajectory_radius",
            "trajectory_length",
            "arc_length",
            "straight_length",
            "poses",
        }
        assert entry["arc_length"] + entry["straight_length"] == pytest.approx(entry["trajectory_length"])
        assert all(0.0 <= yaw < 2.0 * math.pi for _, _, yaw in entry["poses"])


def test_the_map_of_held_curvature_says_what_slip_leaves() -> None:
    model = learned_model()
    held = curvature_map(model, limits=LIMITS, speeds=6, curvatures=9)
    known = np.isfinite(held.held)
    assert known.any()
    assert held.held[known] == pytest.approx((fraction() * held.commanded + 0.0 * held.speed[:, None])[known])
    too_fast = np.abs(held.commanded * held.speed[:, None]) > LIMITS.yaw_rate + 1e-9
    assert not known[too_fast].any()


def test_lattices_that_cannot_be_are_refused() -> None:
    with pytest.raises(SettingsError, match="grid is 0"):
        lattice_primitives(learned_model(), options=LatticeOptions(grid=0.0), limits=LIMITS)
    with pytest.raises(SettingsError, match="turns by 9 headings"):
        lattice_primitives(learned_model(), options=LatticeOptions(turns=9), limits=LIMITS)
    with pytest.raises(PlanningError, match="headings have no primitive"):
        lattice_primitives(learned_model(), options=LatticeOptions(grid=0.9, longest=1.0), limits=LIMITS)
    with pytest.raises(SettingsError, match="two curvatures"):
        curvature_map(learned_model(), curvatures=1)
