# SPDX-License-Identifier: Apache-2.0
"""Quality of service: what a subscription may ask for to match every publisher of its topic."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Quality:
    """What a publisher offers or a subscription asks for; who asks for more than is offered hears nothing."""

    reliable: bool  # what was lost is sent again
    latched: bool  # who comes later gets the last message


def hearing_all(offered: Iterable[Quality], *, latched: bool) -> Quality:
    """Return the most that all publishers offer, and the usual where there is none.

    Args:
        offered: by the publishers known now.
        latched: whether the last message is wanted where publishers keep it.
    """
    known = list(offered)
    return Quality(
        reliable=all(quality.reliable for quality in known),
        latched=latched and all(quality.latched for quality in known),
    )
