# SPDX-License-Identifier: Apache-2.0
"""What a contradiction between the poses and the inputs of a log is, in words."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Contradiction:
    """Poses and inputs that cannot both be right: their difference is no slip."""

    kind: str  # a short stable name, such as "does-not-move"
    sentence: str
    advice: tuple[str, ...]  # what is likely wrong, and the option that cures it
    spoils: bool = True  # no model of this log is good; false: it concerns a small part of the log
