# SPDX-License-Identifier: Apache-2.0
"""What the node says: each thing once until it is over; what was rejected is counted."""

from __future__ import annotations

from collections import Counter, deque

from slipwise.live.outputs import Note

KEPT = 50  # notes; a status carries no more


class Said:
    """Collects notes and counts; a condition is said when it begins, and may be said again after it ended."""

    def __init__(self) -> None:
        self._log: deque[Note] = deque(maxlen=KEPT)
        self._new: list[Note] = []
        self._standing: set[str] = set()
        self.counts: Counter[str] = Counter()

    def note(self, t: float, text: str) -> None:
        """Say something at a stamp [s]."""
        note = Note(t, text)
        self._log.append(note)
        self._new.append(note)

    def begins(self, t: float, condition: str, text: str) -> None:
        """Say that a condition holds, unless that was said."""
        if condition not in self._standing:
            self._standing.add(condition)
            self.note(t, text)

    def ends(self, t: float, condition: str, text: str = "") -> None:
        """Say that a condition is over, where it held."""
        if condition in self._standing:
            self._standing.discard(condition)
            if text:
                self.note(t, text)

    def count(self, reason: str, *, number: int = 1) -> None:
        """Count what was rejected."""
        self.counts[reason] += number

    def take_new(self) -> list[Note]:
        """Return what was said since the last call."""
        new, self._new = self._new, []
        return new

    def log(self) -> tuple[tuple[float, str], ...]:
        """Return the last notes, oldest first: stamp [s] and text."""
        return tuple((note.t, note.text) for note in self._log)
