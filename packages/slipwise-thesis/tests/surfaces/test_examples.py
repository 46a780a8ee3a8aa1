# SPDX-License-Identifier: Apache-2.0
"""Examples are checked once, at the door."""

import logging

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise_thesis.surfaces import slip_examples

DRIVE, SLIP = np.array([[1.0, 0.2], [2.0, -0.1]]), np.zeros((2, 3))


def test_wrong_examples_are_refused_in_one_line(subtests: pytest.Subtests) -> None:
    for drive, slip, std, said in [
        (np.zeros((0, 2)), np.zeros((0, 3)), None, "shape"),
        (DRIVE[:, :1], SLIP, None, "rows of 2"),
        (DRIVE, SLIP[:1], None, "do not match"),
        (DRIVE, SLIP, np.zeros((2, 3)), "not positive"),
        (DRIVE, SLIP, np.ones((1, 3)), "do not match"),
        (DRIVE * [[1.0], [np.nan]], SLIP, None, "first in row 1"),
        (DRIVE, SLIP + np.inf, None, "not finite"),
        (DRIVE, "slip", None, "no numbers"),
    ]:
        with subtests.test(drive=drive, slip=slip, std=std, said=said):
            with pytest.raises(SettingsError, match=said) as caught:
                slip_examples(drive, slip, std)  # type: ignore[arg-type]
            assert "\n" not in str(caught.value)


def test_examples_that_repeat_are_kept_counted_and_said_aloud(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        examples = slip_examples(np.vstack((DRIVE, DRIVE)), np.vstack((SLIP, SLIP)))
    assert (len(examples), examples.duplicates) == (4, 2)
    assert "2 of 4 examples repeat" in caplog.text


def test_examples_with_and_without_standard_deviations_are_not_joined() -> None:
    with pytest.raises(SettingsError, match="cannot be joined"):
        slip_examples(DRIVE, SLIP).joined(slip_examples(DRIVE, SLIP, np.ones((2, 3))))
