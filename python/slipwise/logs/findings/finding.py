# SPDX-License-Identifier: Apache-2.0
"""What is found to be wrong in a log, in words, and the form of a check that finds it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from slipwise.errors import LogError

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen, WholeLog

FAMILIES = ("clocks", "topics", "signs and units", "encoders", "drive", "poses")


@dataclass(frozen=True)
class Finding:
    """Something in a log that cannot be right, or that hides what a robot does."""

    kind: str  # a short stable name, such as "does-not-move"
    sentence: str
    advice: tuple[str, ...]  # what is likely wrong, and the option or parameter that cures it
    spoils: bool = True  # no model of this log is good
    reserves: bool = (
        False  # it is good with reservations; neither: it is said, and the model judged without it
    )
    evidence: float | None = None  # the number that shows it, in the unit of its check

    def __str__(self) -> str:
        """Return the sentence."""
        return self.sentence

    @property
    def judged(self) -> bool:
        """Whether a verdict says it."""
        return self.spoils or self.reserves


#: What a reader worked out, and what it found to be wrong.
Notes = list[str | Finding]


class RefusedLogError(LogError):
    """A log that is not read, since what was found in it makes all of it wrong."""

    def __init__(self, found: Finding, where: str = "") -> None:
        super().__init__(found.sentence, where=where, advice=" ".join(found.advice))
        self.found = found


class Check:
    """What can be found to be wrong: how it is called, and how it is seen in what was measured.

    A subclass says what it is in its class variables, which documents are made of. `look` sees it in the
    motion of inputs and poses, live too, `look_at` in a whole log; what only a reader of files or a live node
    sees, it says by `found`.
    """

    kind: ClassVar[str]
    family: ClassVar[str]  # one of FAMILIES
    means: ClassVar[str]  # for documents: what is wrong
    shows: ClassVar[str]  # for documents: the evidence, and from where on it is one
    cure: ClassVar[str]  # for documents: what to change
    spoils: ClassVar[bool] = True
    reserves: ClassVar[bool] = False  # where it does not spoil
    of_input: ClassVar[bool] = False  # `look_at` asks which input is learned from
    explained_by: ClassVar[
        tuple[str, ...]
    ] = ()  # kinds that it would follow from: not looked for beside them
    hidden_by: ClassVar[tuple[str, ...]] = ("two-sources",)  # kinds beside which it is not said of a log

    def look(self, seen: Seen) -> Finding | None:  # noqa: ARG002
        """Return what was found in inputs and poses; None where nothing was, or it shows elsewhere."""
        return None

    def look_at(self, whole: WholeLog) -> Finding | None:  # noqa: ARG002
        """Return what was found in a whole log; None where nothing was, or it shows elsewhere."""
        return None

    @classmethod
    def found(
        cls, sentence: str, *advice: str, evidence: float | None = None, spoils: bool | None = None
    ) -> Finding:
        """Return a finding of this kind."""
        whole = cls.spoils if spoils is None else spoils
        reserves = cls.reserves and not whole
        return Finding(cls.kind, sentence, tuple(filter(None, advice)), whole, reserves, evidence)
