# SPDX-License-Identifier: Apache-2.0
"""A small drive that several tests look at."""

from __future__ import annotations

from functools import cache

from slipwise.excitation import CommandSpace, Excitation, ExcitationOptions, design_drive, prior_knowledge

SPACE = CommandSpace(1.0, 1.0)
OPTIONS = ExcitationOptions(area=(8.0, 7.0), radius=0.5, minutes=0.7, levels=3, robots=25, checked=1000)


@cache
def small_drive() -> Excitation:
    """Return two figures of four commands for a robot that nothing is known of."""
    return design_drive(prior_knowledge(SPACE), SPACE, OPTIONS)
