# SPDX-License-Identifier: Apache-2.0
"""Fixes by name, by the number of a GGA sentence, and by the status of a ROS message."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs.fixes import CODES, fix_codes, fix_number, fix_words, status_codes


def test_names_and_numbers_of_gga_sentences_are_known() -> None:
    found = fix_codes(["rtk_fixed", "RTK float", "4", "5.0", "0", "", "8"])
    expected = [CODES[name] for name in ("rtk_fixed", "rtk_float", "rtk_fixed", "rtk_float", "none")]
    assert found[:5].tolist() == expected
    assert np.isnan(found[5:]).all()
    assert fix_words(found)[:2].tolist() == ["rtk_fixed", "rtk_float"]
    assert fix_words(found)[5] is None
    assert fix_number("") == 0
    with pytest.raises(LogError, match="unknown fix 'good'"):
        fix_codes(["good"])


def test_the_status_of_a_message_is_a_fix() -> None:
    found = status_codes(np.array([-1.0, 0.0, 1.0, 2.0, np.nan]))
    assert found[:4].tolist() == [CODES[n] for n in ("none", "single", "differential", "rtk_fixed")]
    assert np.isnan(found[4])
