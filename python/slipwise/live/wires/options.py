# SPDX-License-Identifier: Apache-2.0
"""Options of every wire: the node's name, the domain, and whether other hosts are meant."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass

from slipwise.errors import SettingsError


@dataclass(frozen=True)
class WireOptions:
    """How a node joins the graph of ROS."""

    node_name: str = "slipwise"
    namespace: str = "/"
    domain: int | None = None  # 0 to 232; None: what ROS_DOMAIN_ID says, or 0
    network: bool = (
        False  # talk to other hosts, by multicast where the middleware does; otherwise to this one alone
    )

    def domain_number(self) -> int:
        """Return the domain, from the environment where none is given.

        Raises:
            SettingsError: it is no number of a domain.
        """
        text = str(self.domain) if self.domain is not None else os.environ.get("ROS_DOMAIN_ID", "") or "0"
        if not re.fullmatch("[0-9]{1,3}", text) or int(text) > 232:
            raise SettingsError(f'"{text}" is not a ROS domain', advice="domains are numbers from 0 to 232")
        return int(text)
