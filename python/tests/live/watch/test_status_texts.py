# SPDX-License-Identifier: Apache-2.0
"""Numbers of a status are said with the places that they are known to."""

from __future__ import annotations

import math
from datetime import UTC, datetime

import numpy as np
from live.sample_outputs import waiting_status

from slipwise.live.outputs import ParameterNow
from slipwise.live.watch.status_texts import (
    error_texts,
    nis_text,
    parameter_texts,
    slip_texts,
    stamp_text,
)


def test_a_parameter_has_the_places_of_its_standard_deviation() -> None:
    texts = parameter_texts(
        ParameterNow("ang.w", "rad/s per w", -0.291393531, 0.0312345, 0.3, "estimated", 0.0, -0.2912)
    )
    assert (texts.value, texts.std, texts.applied, texts.start) == ("-0.29", "0.03", "-0.29", "0.00")
    assert (texts.prior, texts.unit) == ("0.30", "rad/s per w")


def test_nothing_applied_and_no_unit_are_said_so() -> None:
    texts = parameter_texts(ParameterNow("gain", "-", 1.0, math.inf, math.nan, "invalid", 1.0))
    assert (texts.applied, texts.unit, texts.std, texts.prior) == ("–", "", "–", "–")


def test_slip_is_said_to_the_millimetre_without_a_negative_zero() -> None:
    assert slip_texts(waiting_status()) is None
    slip = np.array([-0.1155903, -0.0000001, math.nan])
    assert slip_texts(waiting_status(slip=slip)) == ("-0.116", "0.000", "–")


def test_held_out_errors_stand_beside_the_baselines() -> None:
    assert error_texts(waiting_status()) == ()
    position, heading = error_texts(waiting_status(held_out=(0.0261, 0.5, 0.52, 0.25)))
    assert (position.learned, position.baseline, position.ratio, position.better) == (
        "0.026",
        "0.52",
        "0.050",
        True,
    )
    assert (heading.unit, heading.ratio, heading.better) == ("rad", "2.0", False)
    assert error_texts(waiting_status(held_out=(0.1, 0.1, 0.0, math.nan)))[0].ratio == "–"


def test_nis_has_two_digits_or_a_dash() -> None:
    assert nis_text(waiting_status()) == "–"
    assert nis_text(waiting_status(nis=1.73686)) == "1.7"


def test_stamps_are_times_of_day_or_seconds() -> None:
    t = 1_700_000_000.0
    assert stamp_text(t) == datetime.fromtimestamp(t, tz=UTC).astimezone().strftime("%H:%M:%S")
    assert stamp_text(12.345) == "12.3 s"
    assert stamp_text(math.nan) == "–"
    assert stamp_text(1e300).endswith(" s")
