# SPDX-License-Identifier: Apache-2.0
"""One figure or table of the thesis made again, with what agrees, what differs and why."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from slipwise_thesis.fixture import MissingLogError
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import Panel


@dataclass(frozen=True, eq=False)
class ThesisFigure:
    """Numbers in the sentences are those of this run: build the sentences from results."""

    key: str  # lower case, digits and hyphens, unique: name of the picture and anchor, as "figure-4-2"
    thesis: str  # what it is called there, as "Figure 4.2"; "Not in the thesis" where it is an addition
    title: str
    shows: str = ""  # what is drawn, one or two sentences
    agrees: str = ""  # with the thesis
    differs: str = ""  # from the thesis, and why
    source: str = ""  # which simulated terrain, or which log
    parts: tuple[Panel | Grid, ...] = ()
    missing: str = ""  # what is missing and how to give it; then there is nothing else to show

    def __post_init__(self) -> None:
        """Refuse a figure that shows something and does not say what."""
        texts = {"shows": self.shows, "agrees": self.agrees, "differs": self.differs, "source": self.source}
        empty = [name for name, text in texts.items() if not text.strip()]
        if not self.missing and (empty or not self.parts):
            raise ValueError(f"{self.key}: empty {', '.join([*empty, 'parts' * (not self.parts)])}")

    @property
    def panels(self) -> tuple[Panel, ...]:
        """The parts that are drawn."""
        return tuple(part for part in self.parts if isinstance(part, Panel))

    @property
    def grids(self) -> tuple[Grid, ...]:
        """The parts that are tables."""
        return tuple(part for part in self.parts if isinstance(part, Grid))


def figure_of_log(key: str, thesis: str, title: str, make: Callable[[], ThesisFigure]) -> ThesisFigure:
    """Return what `make` makes from a real log, or a figure that says which log is missing."""
    try:
        return make()
    except MissingLogError as error:
        return ThesisFigure(key, thesis, title, missing=str(error))
