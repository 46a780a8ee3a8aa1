# SPDX-License-Identifier: Apache-2.0
"""What the node says: each thing once until it is over; what was rejected is counted."""

from __future__ import annotations

from collections import Counter, deque

from slipwise.live.outputs import Note

KEPT = 50  # notes; a status carries no more
MOST_REASONS = 200  # that are counted apart: samples name some of them, and memory is not theirs
OTHERS = "other reasons"
LONGEST = 1000  # characters of a note


class Said:
    """Collects notes and counts; a condition is said when it begins, and may be said again after it ended."""

    def __init__(self) -> None:
        self._log: deque[Note] = deque(maxlen=KEPT)
        self._new: list[Note] = []
        self._standing: set[str] = set()
        self._once: set[str] = set()
        self.counts: Counter[str] = Counter()

    def note(self, t: float, text: str, *, error: bool = False) -> None:
        """Say something at a stamp [s]; an error is shown to those who asked for quiet too."""
        note = Note(t, text[:LONGEST], error)
        self._log.append(note)
        self._new.append(note)

    def once(self, t: float, kind: str, text: str) -> None:
        """Say the first of each kind of fault; of kinds beyond a number only the count tells."""
        if kind not in self._once and len(self._once) < MOST_REASONS:
            self._once.add(kind)
            self.note(t, text, error=True)

    def begins(self, t: float, condition: str, text: str, *, error: bool = False) -> None:
        """Say that a condition holds, unless that was said."""
        if condition not in self._standing:
            self._standing.add(condition)
            self.note(t, text, error=error)

    def ends(self, t: float, condition: str, text: str = "") -> None:
        """Say that a condition is over, where it held."""
        if condition in self._standing:
            self._standing.discard(condition)
            if text:
                self.note(t, text)

    def count(self, reason: str, *, number: int = 1) -> None:
        """Count what was rejected."""
        known = reason in self.counts or len(self.counts) < MOST_REASONS
        self.counts[reason if known else OTHERS] += number

    def take_new(self) -> list[Note]:
        """Return what was said since the last call."""
        new, self._new = self._new, []
        return new

    def log(self) -> tuple[tuple[float, str], ...]:
        """Return the last notes, oldest first: stamp [s] and text."""
        return tuple((note.t, note.text) for note in self._log)
