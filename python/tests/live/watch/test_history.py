# SPDX-License-Identifier: Apache-2.0
"""A watcher remembers the newest of each output, a fused path that begins again, and the last NIS."""

from __future__ import annotations

import itertools
import math

from live.sample_outputs import odometry_at, straight_path, waiting_status

from slipwise.live.outputs import Note
from slipwise.live.watch.history import MOST_FUSED, MOST_NIS, MOST_NOTES, History


def test_before_anything_there_is_nothing() -> None:
    seen = History().seen()
    assert (seen.status, seen.predicted, seen.odometry) == (None, None, None)
    assert (seen.fused, seen.nis, seen.notes, seen.count) == ((), (), (), 0)


def test_the_fused_path_has_points_apart_and_forgets_the_oldest() -> None:
    history = History()
    for i in range(4 * MOST_FUSED):
        history.take(odometry_at(0.1 * i, (0.02 * i, 0.0, 0.0)))
    fused = history.seen().fused
    assert len(fused) == MOST_FUSED
    steps = [math.dist(a, b) for a, b in itertools.pairwise(fused)]
    assert min(steps) >= 0.03
    assert fused[-1][0] > 0.02 * (4 * MOST_FUSED - 3)


def test_the_fused_path_begins_again_after_a_jump_and_skips_what_is_no_place() -> None:
    history = History()
    history.take(odometry_at(0.0, (0.0, 0.0, 0.0)))
    history.take(odometry_at(0.1, (math.nan, 0.0, 0.0)))
    history.take(odometry_at(0.2, (1.0, 0.0, 0.0)))
    assert history.seen().fused == ((0.0, 0.0), (1.0, 0.0))
    history.take(odometry_at(0.3, (100.0, 0.0, 0.0)))
    assert history.seen().fused == ((100.0, 0.0),)


def test_nis_is_kept_once_a_segment() -> None:
    history = History()
    for segments, nis in ((1, 2.0), (1, 2.0), (2, 4.0), (3, None), (4, math.nan)):
        history.take(waiting_status(t=10.0 + segments, segments=segments, nis=nis))
    assert history.seen().nis == ((1, 2.0), (2, 4.0))
    for segments in range(5, 5 + 2 * MOST_NIS):
        history.take(waiting_status(segments=segments, nis=1.0))
    assert len(history.seen().nis) == MOST_NIS
    history.take(waiting_status(segments=1, nis=9.0))
    assert history.seen().nis == ((1, 9.0),)


def test_notes_come_newest_first_from_the_status_or_before_there_is_one() -> None:
    history = History()
    for i in range(2 * MOST_NOTES):
        history.take(Note(float(i), f"note {i}"))
    assert history.seen().notes[0] == (2.0 * MOST_NOTES - 1, f"note {2 * MOST_NOTES - 1}")
    assert len(history.seen().notes) == MOST_NOTES
    history.take(waiting_status(log=((1.0, "a"), (2.0, "b"))))
    assert history.seen().notes == ((2.0, "b"), (1.0, "a"))


def test_an_answer_to_a_request_is_not_the_path_of_the_present_command() -> None:
    history = History()
    history.take(straight_path(asked=True))
    assert history.seen().predicted is None
    path = straight_path()
    history.take(path)
    assert history.seen().predicted is path


def test_what_the_newest_status_does_not_know_is_not_shown_from_before() -> None:
    history = History()
    history.take(straight_path())
    history.take(odometry_at(1.0))
    history.take(waiting_status())
    assert (history.seen().predicted, history.seen().odometry) == (None, None)
