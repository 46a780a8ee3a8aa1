# SPDX-License-Identifier: Apache-2.0
"""Lessons begin with what was known and get surer move by move."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from excitation.samples import small_drive

from slipwise.excitation import lessons_of


def test_first_lesson_is_what_was_known_before() -> None:
    drive = small_drive()
    first = lessons_of(drive)[0]
    assert first.move is None
    np.testing.assert_allclose(first.std, np.sqrt(np.diag(drive.knowledge.covariance)), rtol=1e-9)


def test_no_move_makes_anything_less_sure() -> None:
    drive = small_drive()
    lessons = lessons_of(drive)
    assert [lesson.move for lesson in lessons[1:]] == list(drive.moves)
    for before, after in pairwise(lessons):
        assert after.yaw <= before.yaw * (1.0 + 1e-9)
        assert after.position <= before.position * (1.0 + 1e-9)
        assert (after.std <= before.std * (1.0 + 1e-9)).all()
    assert lessons[-1].yaw < 0.25 * lessons[0].yaw
