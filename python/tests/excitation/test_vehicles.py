# SPDX-License-Identifier: Apache-2.0
"""Vehicles are found by name, and each says where its numbers come from."""

from __future__ import annotations

import pytest

from slipwise.errors import SettingsError
from slipwise.excitation import VEHICLES, vehicle_named
from slipwise.logs import LogOptions
from slipwise_sim.drive import TOP_SPEED, TOP_YAW_RATE
from slipwise_sim.land_tamer import LandTamer


def test_every_vehicle_has_a_size_and_a_source() -> None:
    for name in VEHICLES:
        vehicle = vehicle_named(name)
        assert vehicle.radius > 0.0
        assert vehicle.source


@pytest.mark.parametrize("name", ["husky", "jackal", "warthog", "turtlebot3-burger", "turtlebot4"])
def test_vehicles_of_logs_have_a_drive_too(name: str) -> None:
    assert vehicle_named(name).space.speed > 0.0
    assert LogOptions(vehicle=name).vehicle == name


def test_unknown_vehicle_is_refused_with_the_known_ones() -> None:
    with pytest.raises(SettingsError, match="husky"):
        vehicle_named("unicycle")


def test_land_tamer_is_the_simulated_one() -> None:
    vehicle, tamer = vehicle_named("land-tamer"), LandTamer()
    assert (vehicle.space.speed, vehicle.space.yaw_rate) == (TOP_SPEED, TOP_YAW_RATE)
    length, width = tamer.hull_size[0], tamer.wheel_separation + tamer.wheel_width
    assert vehicle.radius >= (length**2 + width**2) ** 0.5 / 2.0
