# SPDX-License-Identifier: Apache-2.0
"""Names of topics and services as ROS accepts them."""

from __future__ import annotations

import re

from slipwise.errors import SettingsError

_PART = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def require_topic(name: str) -> str:
    """Return the name of a topic or service, which has to be absolute.

    Raises:
        SettingsError: it is not.
    """
    first, *parts = name.split("/")
    if first or not parts or not all(_PART.fullmatch(part) for part in parts):
        raise SettingsError(
            f'"{name}" is not the name of a topic', advice='write it with its slash, such as "/odom"'
        )
    return name
