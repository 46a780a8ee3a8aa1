# SPDX-License-Identifier: Apache-2.0
"""The domain comes from the options, the environment, or is 0."""

from __future__ import annotations

import pytest

from slipwise.errors import SettingsError
from slipwise.live.wires.wire import WireOptions


def test_the_domain_given_wins_over_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    assert WireOptions(domain=5).domain_number() == 5
    assert WireOptions().domain_number() == 7
    monkeypatch.delenv("ROS_DOMAIN_ID")
    assert WireOptions().domain_number() == 0


@pytest.mark.parametrize("domain", ["233", "-1", "one", "²"])
def test_no_domain_is_refused(domain: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    with pytest.raises(SettingsError, match="not a ROS domain"):
        WireOptions().domain_number()
