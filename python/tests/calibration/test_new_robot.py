# SPDX-License-Identifier: Apache-2.0
"""A drive for a robot of a fleet knows what the fleet has, and keeps each of its robots inside."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from excitation.samples import OPTIONS
from fleet.fleet_samples import BASIS, known_fleet

from slipwise.calibration.from_prior import KnownFleet
from slipwise.calibration.new_robot import new_robot_knowledge
from slipwise.errors import ModelError
from slipwise.excitation import CommandSpace, Knowledge, design_drive, drawn_robots, prior_knowledge
from slipwise.excitation.moves import command_periods
from slipwise.fleet.start_prior import start_prior
from slipwise.models.fleet_prior import FleetPriorFile

SPACE = CommandSpace(1.0, 0.5)


@cache
def prior() -> KnownFleet:
    start = start_prior(known_fleet("command"))
    content = FleetPriorFile(slipwise_fleet_prior=2, type="", robots=4, logs=4, parameters={}, start=start)
    return KnownFleet(Path("fleet.yaml"), content)


def std_of(knowledge: Knowledge, name: str) -> float:
    place = knowledge.names.index(name)
    return float(np.sqrt(knowledge.covariance[place, place]))


@pytest.mark.slow
def test_a_fleet_knows_more_of_its_robots_than_nobody_does() -> None:
    fleet, nobody = new_robot_knowledge(prior()), prior_knowledge(SPACE)
    place = fleet.names.index("ang.w")
    assert fleet.mean[place] == pytest.approx(-0.35, abs=0.06)
    for name in ("ang.w", "lon.V"):
        assert std_of(fleet, name) < 0.4 * std_of(nobody, name)


@pytest.mark.slow
def test_robots_of_a_fleet_are_drawn_basis_by_basis() -> None:
    kinds = new_robot_knowledge(prior()).kinds
    assert sum(weight for weight, _ in kinds) == pytest.approx(1.0)
    assert BASIS.name in {kind.motion.basis.name for _, kind in kinds}
    for _, kind in kinds:
        assert len(kind.mean) == len(kind.names)


@pytest.mark.slow
def test_a_thousand_robots_drawn_from_the_fleets_prior_stay_inside_the_area() -> None:
    knowledge = new_robot_knowledge(prior())
    options = replace(OPTIONS, area=(10.0, 10.0), minutes=0.4, checked=2000)
    drive = design_drive(knowledge, SPACE, options)
    robots = drawn_robots(knowledge, 1000, seed=77)
    assert len(robots.programs) == 1000
    box = robots.box(command_periods(drive.moves, 0.1))
    x, y = drive.start
    assert min(x + box[0], y + box[2]) >= options.radius
    assert max(x + box[1], y + box[3]) <= 10.0 - options.radius


@pytest.mark.slow
def test_a_fleet_of_wheel_speeds_is_refused_since_it_knows_no_lag() -> None:
    start = prior().content.start
    assert start is not None
    content = prior().content.model_copy(update={"start": start.model_copy(update={"input": "wheel"})})
    of_wheels = KnownFleet(Path("fleet.yaml"), content)
    with pytest.raises(ModelError, match="lag behind commands"):
        new_robot_knowledge(of_wheels)
