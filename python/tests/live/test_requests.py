# SPDX-License-Identifier: Apache-2.0
"""A prediction that is asked for without what it takes is answered with what is missing."""

from __future__ import annotations

import json

import numpy as np
import pytest

from slipwise.live.requests import asked_commands

NAMES = ("v", "omega")


@pytest.mark.parametrize("asked", [{"horizon": 2}, {}, [], 7])
def test_a_request_without_commands_says_what_to_give(asked: object) -> None:
    with pytest.raises(ValueError, match=r"it has no commands: give \[t, v, omega\] of each as 'commands'"):
        asked_commands(json.dumps(asked), NAMES, newest=10.0, horizon=2.0)


def test_commands_are_rows_for_the_horizon_that_is_asked_for() -> None:
    rows, horizon = asked_commands(
        '{"horizon": 3, "commands": [[11, 0.5, 0.1]]}', NAMES, newest=10.0, horizon=2.0
    )
    np.testing.assert_array_equal(rows, [[11.0, 0.5, 0.1]])
    assert horizon == 3.0
