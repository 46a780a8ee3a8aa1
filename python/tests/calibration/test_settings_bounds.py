# SPDX-License-Identifier: Apache-2.0
"""Whatever number the settings allow, learning ends in a finite model or in one line."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import BaseModel
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings, calibrate, make_settings
from slipwise.errors import SlipwiseError
from slipwise.logs import Log


@cache
def driven() -> Log:
    return simulated_log(Drive(seconds=40.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.3)))


def numbers_with_bounds() -> Iterator[Any]:
    """Yield each number of the settings with one of its bounds: section, key, and what to set."""
    for section, about in Settings.model_fields.items():
        table = about.annotation
        if not (isinstance(table, type) and issubclass(table, BaseModel)):
            continue
        for key, field in table.model_fields.items():
            listed = isinstance(field.default, list) and field.default and isinstance(field.default[0], float)
            marks = get_args(field.annotation)[0].__metadata__ if listed else (field,)
            limits = [limit for mark in marks for limit in mark.metadata]
            sides = [(side, limit) for limit in limits for side in ("ge", "le") if hasattr(limit, side)]
            found = {(side, getattr(limit, side)) for side, limit in sides}
            for side, bound in sorted(found):
                value = [bound] * len(field.default) if listed else bound
                yield pytest.param(section, key, value, id=f"{section}.{key}-{side}-{bound:g}")


@pytest.mark.slow
@pytest.mark.parametrize(("section", "key", "value"), list(numbers_with_bounds()))
def test_learning_at_the_bound_of_a_setting_gives_a_verdict_or_one_line(
    section: str, key: str, value: Any
) -> None:
    content = {section: {key: value}}
    for source in ("command", "wheel"):
        refused = ""
        try:
            model = calibrate(driven(), input=source, settings=make_settings(content)).model
            assert np.isfinite(model.mean).all()
        except SlipwiseError as error:
            refused = str(error)
        assert "\n" not in refused
