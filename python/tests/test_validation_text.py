# SPDX-License-Identifier: Apache-2.0
"""Wrong documents are refused in slipwise's words; those of the checking library never reach a user."""

import re

import pytest

from slipwise.calibration import make_settings
from slipwise.errors import SettingsError

FOREIGN = re.compile(
    r"pydantic|Value error|Input should|Extra inputs|valid (number|string)|http", re.IGNORECASE
)


def test_wrong_settings_are_named_in_plain_words(subtests: pytest.Subtests) -> None:
    for content, words in [
        ({"estimator": "magic"}, "estimator: unknown estimator 'magic'; known are average"),
        ({"filter": {"huber": -1.0}}, "filter.huber: must be at least 1e-09, not -1.0"),
        ({"prior": {"slip_fraction": 11}}, "prior.slip_fraction: must be at most 10, not 11"),
        ({"log": {"wheel_separation": -1.0}}, "log.wheel_separation: must be more than 0, not -1.0"),
        ({"filter": {"huber": "much"}}, "filter.huber: must be a number, not 'much'"),
        (
            {"log": {"wheel_separation": float("inf")}},
            "log.wheel_separation: must be a finite number, not inf",
        ),
        ({"filter": 3}, "filter: must be a table of keys, not 3"),
        ({"auto": {"bases": []}}, "auto.bases: needs at least 1 entries"),
        ({"auto": {"bases": "edd-2"}}, "auto.bases: must be a list, not 'edd-2'"),
        ({"change": {"branches": "perhaps"}}, "change.branches: must be true or false, not 'perhaps'"),
        (
            {"smoothing": {"drift": "up"}},
            "smoothing.drift: must be 'mean-reverting' or 'random-walk', not 'up'",
        ),
        ({"noise": {"psd_time": [1.0]}}, "noise.psd_time: needs at least 3 entries"),
        ({"colour": 1}, "colour: there is no such key"),
        ({"basis": 3}, "basis: must be text, not 3"),
    ]:
        with subtests.test(content=content, words=words):
            with pytest.raises(SettingsError) as caught:
                make_settings(content)
            assert caught.value.what.startswith(words)
            assert caught.value.advice
            assert not FOREIGN.search(str(caught.value))


def test_a_long_wrong_value_is_shortened() -> None:
    with pytest.raises(SettingsError) as caught:
        make_settings({"change": {"branches": "x" * 500}})
    assert len(caught.value.what) < 120
