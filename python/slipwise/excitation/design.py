# SPDX-License-Identifier: Apache-2.0
"""Chooses the moves of a drive: the worst prediction as sure as can be, and every robot inside its area."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import PlanningError, SettingsError
from slipwise.excitation.command_space import CommandSpace
from slipwise.excitation.information import (
    PoseStd,
    WorstPrediction,
    information,
    move_jacobians,
    prediction_jacobians,
    prior_information,
)
from slipwise.excitation.knowledge import Knowledge
from slipwise.excitation.moves import ORDERS, Move, command_periods, figure_of
from slipwise.excitation.robots import PERIOD, Robots, drawn_robots, edge_robots

Floats = NDArray[np.float64]

HORIZON = 2.0  # s, of the predictions that are to be sure
LEAD = 1.0  # s of standing before the first move
JUDGED_LEVELS = 7  # of speed and yaw rate from zero to their limits, of the predictions
#: Of the limits of speed and yaw rate, as the fastest moves.
FRACTIONS = (
    (1.0, 1.0),
    (0.7, 1.0),
    (0.5, 1.0),
    (0.35, 1.0),
    (0.5, 0.5),
    (0.25, 0.7),
    (0.25, 0.4),
    (0.1, 0.2),
)
AREA_FRACTIONS = (1.0, 0.8, 0.6, 0.45)  # of the area, while choosing
WIDER = 1.25  # times as different from the expected robot as robots are likely to be, are these
RARE = 0.05  # of the robots at least are of each kind, where there are several
TRIED = 6  # candidates whose paths are computed at once
MOST_TRIED = 180  # candidates per figure
CUT_SHORT = 1.0  # weight of the knowledge after five moves of a figure, beside that after all eight


@dataclass(frozen=True)
class ExcitationOptions:
    """Where, how long and how a drive is driven.

    Raises:
        SettingsError: a number makes no sense, or hold and pause are not multiples of a tenth of a second.
    """

    area: tuple[float, float] | None = (8.0, 8.0)  # m along the robot's first heading, m across; None: any
    minutes: float = 1.0  # at most
    radius: float = 0.5  # m, of a disc that covers the robot; all of it stays inside the area
    hold: float = 2.0  # s of a command
    pause: float = 0.5  # s of standing after it
    std: PoseStd = PoseStd()
    levels: int = 5  # of speed and yaw rate from zero to their limits, of the moves
    robots: int = 125  # that the drive is chosen for
    checked: int = 10_000  # other robots, none of which may leave the area
    seed: int = 1  # of these

    def __post_init__(self) -> None:
        for name in ("minutes", "radius", "hold"):
            _check(name, getattr(self, name), self.radius >= 0.0 if name == "radius" else None)
        for side in self.area or ():
            _check("area", side)
        for name, seconds in (("hold", self.hold), ("pause", self.pause)):
            steps = seconds / PERIOD
            if not (math.isfinite(steps) and steps >= 0.0 and abs(steps - round(steps)) < 1e-6):
                raise SettingsError(
                    f"{name} is {seconds} s", where=name, advice=f"give a multiple of {PERIOD:g} s"
                )

    @property
    def groups(self) -> int:
        """How many groups of four moves the time allows."""
        return int((60.0 * self.minutes - LEAD) / (4.0 * (self.hold + self.pause)) + 1e-9)

    @property
    def room(self) -> Floats:
        """Width and depth that base_link may move in [2] m."""
        if self.area is None:
            return np.full(2, np.inf)
        return np.array(self.area) - 2.0 * self.radius


_Found = tuple[float, tuple[Move, ...], Floats]  # score, moves, box


@dataclass(frozen=True, eq=False)
class Excitation:
    """A drive: moves in groups of four, from standing for `LEAD` seconds on."""

    moves: tuple[Move, ...]
    box: Floats  # [4] least and largest x, y [m] that any robot reaches of those it was checked with
    space: CommandSpace
    options: ExcitationOptions
    knowledge: Knowledge

    @property
    def seconds(self) -> float:
        """How long it takes [s]."""
        return LEAD + sum(move.seconds for move in self.moves)

    @property
    def start(self) -> tuple[float, float]:
        """Where base_link stands at first: m from the area's left lower corner, the heading along its x."""
        centre = np.array([self.box[:2].mean(), self.box[2:].mean()])
        half = np.zeros(2) if self.options.area is None else 0.5 * np.array(self.options.area)
        x, y = (half - centre).tolist()
        return x, y


def design_drive(
    knowledge: Knowledge,
    space: CommandSpace,
    options: ExcitationOptions,
    *,
    progress: Callable[[float], None] | None = None,
) -> Excitation:
    """Choose the drive after which the worst prediction within the command space is surest.

    Moves come in figures of two commands that end with the heading they began with (`figure_of`). Figure by
    figure, the one is taken after which the worst prediction is surest, of those that keep robots at the edge
    of what is likely inside the area. That is tried with several limits of the speed, since a slow drive may
    go on where a fast one has no room left. The best drive counts that keeps all checked robots inside.

    Raises:
        SettingsError: the time allows no group of moves.
        PlanningError: in this area no move is safe.
    """
    if options.groups < 1:
        least = (LEAD + 4.0 * (options.hold + options.pause)) / 60.0
        raise SettingsError(
            f"{options.minutes:g} minutes are too short for a group of moves",
            where="minutes",
            advice=f"give {least:.2f} or more, or shorter moves",
        )
    few = edge_robots(knowledge, options.robots, seed=options.seed)
    many = drawn_robots(knowledge.spread_by(WIDER), options.checked, seed=options.seed + 1, least=RARE)
    judge = WorstPrediction(prediction_jacobians(knowledge, space.grid(JUDGED_LEVELS), HORIZON))
    best: _Found | None = None
    for done, fractions in enumerate(FRACTIONS):
        if progress is not None:
            progress(done / len(FRACTIONS))
        search = _Search(knowledge, space.slower(*fractions), options, few, judge)
        best = _checked(search, many, best)
        if options.area is None:
            break
    if best is None:
        raise PlanningError(
            "no move keeps every likely robot inside this area",
            where="area",
            advice="give a larger area, a model learned from a careful first drive, or shorter moves",
        )
    return Excitation(best[1], best[2], space, options, knowledge)


class _Search:
    """Greedy choice of figures at one limit of the speed."""

    def __init__(
        self,
        knowledge: Knowledge,
        space: CommandSpace,
        options: ExcitationOptions,
        robots: Robots,
        judge: WorstPrediction,
    ) -> None:
        self.options, self.judge, self._robots = options, judge, robots
        self._prior = prior_information(knowledge)
        commands = space.quadrant(options.levels)
        alone = [[command] for command in commands.tolist()]
        self._commands = commands[self._inside([], alone, options.room)[0]]
        informed = [self._informed(knowledge, command) for command in self._commands.tolist()]
        size = len(self._prior)
        self._informed_by_four = np.array([sum(parts) for parts in informed]).reshape(-1, size, size)
        self._informed_by_three = np.array([sum(parts[:3]) for parts in informed]).reshape(-1, size, size)
        self._informed_by_two = np.array([sum(parts[:2]) for parts in informed]).reshape(-1, size, size)

    def drive(self, room: Floats) -> tuple[float, list[Move]]:
        """Return the score of the worst predictions and the moves of the drive found in this room [2] m."""
        known: Floats = self._prior
        moves: list[Move] = []
        left = self.options.groups if len(self._commands) else 0
        while left:
            scores = (
                self._scores_of_two(known) if left > 1 else self.judge.scores(known + self._informed_by_four)
            )
            ranked = np.argsort(scores.ravel(), kind="stable")[_tried_ranks(scores.size)]
            places = np.column_stack(np.unravel_index(ranked, scores.shape))
            taken = self._first_inside(moves, places, room)
            if taken is None:
                break
            place, figure = taken
            moves.extend(figure)
            known = known + self._informed_by_four[place].sum(axis=0)
            left -= len(place)
        return float(self.judge.scores(known[None])[0]), moves

    def _informed(self, knowledge: Knowledge, command: Sequence[float]) -> list[Floats]:
        """What each of the four moves with this command tells, from rest."""
        moves = figure_of([command], ORDERS[0], self.options.hold, self.options.pause)
        return [information(move_jacobians(knowledge, [move])[0], self.options.std) for move in moves]

    def _scores_of_two(self, known: Floats) -> Floats:
        """Return the scores [N, N] of figures of two commands, after five moves and after all eight."""
        count, size = len(self._commands), len(known)
        five = known + self._informed_by_three[:, None] + self._informed_by_two
        eight = known + self._informed_by_four[:, None] + self._informed_by_four
        cut, whole = (self.judge.scores(after.reshape(-1, size, size)) for after in (five, eight))
        return (whole + CUT_SHORT * cut).reshape(count, count)

    def _first_inside(
        self, moves: list[Move], places: NDArray[np.int64], room: Floats
    ) -> tuple[NDArray[np.int64], list[Move]] | None:
        """Return the first candidate [1 or 2] that has an order inside the room, and its figure."""
        for first in range(0, len(places), TRIED):
            tried = places[first : first + TRIED]
            inside, figures = self._inside(moves, [self._commands[place].tolist() for place in tried], room)
            if inside.any():
                best = int(np.argmax(inside))
                return tried[best], figures[best]
        return None

    def _inside(
        self, moves: list[Move], candidates: list[list[list[float]]], room: Floats
    ) -> tuple[NDArray[np.bool_], list[list[Move]]]:
        """Return which candidates keep the robots inside after these moves, and the figure of each.

        Of the orders that do, it is the one that ends nearest to the start.
        """
        options, count = self.options, len(ORDERS)
        figures = [
            figure_of(commands, order, options.hold, options.pause)
            for commands in candidates
            for order in ORDERS
        ]
        if options.area is None:
            return np.ones(len(candidates), dtype=bool), figures[::count]
        drives = np.array([command_periods([*moves, *figure], PERIOD) for figure in figures])
        inside, end = self._robots.inside(drives, room)
        far = np.where(inside, end, np.inf).reshape(-1, count)
        nearest = np.argmin(far, axis=1)
        return np.isfinite(far.min(axis=1)), [figures[i * count + k] for i, k in enumerate(nearest.tolist())]


def _tried_ranks(count: int) -> NDArray[np.int64]:
    """Return the ranks that are tried: all of a few; of many, those at the head densely, others sparsely."""
    spaced = np.linspace(0.0, 1.0, min(count, MOST_TRIED)) ** 2 * (count - 1)
    return np.unique(np.round(spaced).astype(np.int64))


def _checked(search: _Search, many: Robots, best: _Found | None) -> _Found | None:
    """Return the better of the best drive so far and one that keeps many robots inside, None without any."""
    room = search.options.room
    for fraction in AREA_FRACTIONS:
        score, moves = search.drive(fraction * room)
        if not moves or (best is not None and score >= best[0]):
            return best  # with less room, it would be no better
        box = many.box(command_periods(moves, PERIOD), room)
        if box is not None:
            return score, tuple(moves), box
    return best


def _check(name: str, value: float, possible: bool | None = None) -> None:
    if not (math.isfinite(value) and (value > 0.0 if possible is None else possible)):
        raise SettingsError(f"{name} is {value}", where=name, advice="give a positive number")
