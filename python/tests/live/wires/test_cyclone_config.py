# SPDX-License-Identifier: Apache-2.0
"""Cyclone DDS stays on this host unless told otherwise."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest
from live.wires.peer import DOMAIN

from slipwise.errors import SettingsError
from slipwise.live.wires.cyclone_config import close_domain, cyclone_config, open_domain


def test_without_the_network_only_loopback_is_used_and_no_multicast(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CYCLONEDDS_URI", "<CycloneDDS/>")
    read = ET.fromstring(cyclone_config(network=False))
    interfaces = [found.attrib for found in read.iter("NetworkInterface")]
    assert interfaces == [{"address": "127.0.0.1"}]
    assert read.findtext("Domain/General/AllowMulticast") == "false"
    assert [found.attrib for found in read.iter("Peer")] == [{"Address": "127.0.0.1"}]


def test_with_the_network_the_user_decides_last(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CYCLONEDDS_URI", "file:///robot.xml")
    assert cyclone_config(network=True).endswith(",file:///robot.xml")
    monkeypatch.delenv("CYCLONEDDS_URI")
    read = ET.fromstring(cyclone_config(network=True))
    assert read.find("Domain/General") is None


def test_descriptions_of_types_of_fast_dds_are_ignored() -> None:
    read = ET.fromstring(cyclone_config(network=False))
    assert "1.15" in (read.findtext("Domain/Compatibility/IgnoreTypeInformation") or "").split(",")


def test_a_domain_has_one_configuration_in_a_process() -> None:
    pytest.importorskip("cyclonedds")
    number = DOMAIN + 101
    open_domain(number, network=False)
    open_domain(number, network=False)
    with pytest.raises(SettingsError, match="in use"):
        open_domain(number, network=True)
    close_domain(number)
    close_domain(number)
    with pytest.raises(KeyError):
        close_domain(number)
