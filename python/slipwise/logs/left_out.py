# SPDX-License-Identifier: Apache-2.0
"""Counts rejected samples of a log, so that nothing is ever dropped in silence."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from slipwise.logs.log import LeftOut, Log


class Tally:
    """Collects rejected samples; equal reasons are added up and keep their first place."""

    def __init__(self) -> None:
        self._entries: dict[tuple[str, str], tuple[int, str]] = {}

    def add(self, kind: str, reason: str, *, count: int, where: str) -> None:
        """Count `count` things of one kind, the first of them at `where`; a count of 0 changes nothing."""
        if count <= 0:
            return
        before, first = self._entries.get((kind, reason), (0, where))
        self._entries[kind, reason] = (before + count, first)

    def add_lines(self, kind: str, reason: str, numbers: Sequence[int], place: Callable[[int], str]) -> None:
        """Count numbered lines, or whatever a file consists of; `place` says where one with a number is."""
        if numbers:
            self.add(kind, reason, count=len(numbers), where=place(numbers[0]))

    def result(self) -> tuple[LeftOut, ...]:
        """Return the entries in the order in which they were met."""
        return tuple(
            LeftOut(reason=reason, count=count, where=where, kind=kind)
            for (kind, reason), (count, where) in self._entries.items()
        )


def samples_left_out(log: Log, name: str, *kinds: str) -> int:
    """Return how many samples of a name, such as "poses", were left out as one of some kinds."""
    return sum(each.count for each in log.left_out if each.kind in kinds and each.reason.startswith(name))
