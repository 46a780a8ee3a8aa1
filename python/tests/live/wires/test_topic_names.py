# SPDX-License-Identifier: Apache-2.0
"""Names of topics are absolute, and of letters, digits and underscores."""

from __future__ import annotations

import pytest

from slipwise.errors import SettingsError
from slipwise.live.wires.wire import require_topic


@pytest.mark.parametrize("name", ["/odom", "/robot_1/cmd_vel", "/_hidden/a/b"])
def test_absolute_names_are_taken(name: str) -> None:
    assert require_topic(name) == name


def test_other_names_are_refused(subtests: pytest.Subtests) -> None:
    for name in ["", "/", "odom", "~/odom", "/odom/", "//odom", "/1st", "/o dom", "/odom*", "/ödom"]:
        with subtests.test(name=name), pytest.raises(SettingsError, match="not the name of a topic"):
            require_topic(name)
