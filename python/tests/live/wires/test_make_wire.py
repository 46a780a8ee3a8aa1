# SPDX-License-Identifier: Apache-2.0
"""The wire that was asked for is opened, or the first that is installed; or it is said what to install."""

from __future__ import annotations

import pytest
from live.wires.peer import DOMAIN

from slipwise.errors import SettingsError
from slipwise.live.wires import make_wire as module
from slipwise.live.wires.make_wire import WIRE_NAMES, make_wire, wires_at_hand
from slipwise.live.wires.wire import WireOptions


def install(monkeypatch: pytest.MonkeyPatch, *packages: str) -> None:
    monkeypatch.setattr(module, "find_spec", lambda name: name if name in packages else None)


def test_rclpy_is_best_then_cyclonedds(monkeypatch: pytest.MonkeyPatch) -> None:
    install(monkeypatch, "cyclonedds", "rclpy")
    assert wires_at_hand() == ["rclpy", "cyclonedds"] == list(WIRE_NAMES)


def test_without_a_name_the_first_that_is_installed_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cyclonedds")
    install(monkeypatch, "cyclonedds")
    wire = make_wire(None, WireOptions(domain=DOMAIN))
    assert wire.name == "cyclonedds"
    wire.close()


def test_nothing_installed_names_all_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    install(monkeypatch)
    with pytest.raises(SettingsError) as caught:
        make_wire(None, WireOptions())
    assert all(way in str(caught.value) for way in ("setup.bash", "pip install 'cyclonedds"))


@pytest.mark.parametrize(
    ("name", "advice"),
    [("cyclonedds", "pip install 'cyclonedds"), ("rclpy", "setup.bash")],
)
def test_a_missing_package_is_named_with_its_extra(
    name: str, advice: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(monkeypatch)
    with pytest.raises(SettingsError, match=f"{name} is not installed") as caught:
        make_wire(name, WireOptions())
    assert advice in caught.value.advice


def test_a_package_that_is_there_but_broken_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    install(monkeypatch, "rclpy")
    with pytest.raises(SettingsError, match="rclpy cannot be imported"):
        make_wire("rclpy", WireOptions())


def test_an_unknown_transport_is_refused_with_those_that_exist() -> None:
    with pytest.raises(SettingsError, match=r'no transport "dds".*rclpy, cyclonedds'):
        make_wire("dds", WireOptions())
