# SPDX-License-Identifier: Apache-2.0
"""Whatever number a settings file allows, learning ends in a finite model or in one line."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings, calibrate, make_settings
from slipwise.calibration.keys import keys_of
from slipwise.errors import SettingsError, SlipwiseError


def at_bounds() -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """Yield each number of learning that users may set, with the smallest and the largest value it takes."""
    for key in keys_of(Settings):
        listed = isinstance(key.default, list) and key.default and isinstance(key.default[0], float)
        number = key.path == "segment.length" or isinstance(key.default, float) or listed
        if not number or key.table.startswith(("live", "log")):
            continue
        for bound in (1e-9, 0.0, -np.pi, np.pi, -50.0, 50.0, 10.0, 1e6):
            content = {key.table: {key.name: [bound] * len(key.default) if listed else bound}}
            try:
                make_settings(content)
            except SettingsError:
                continue  # beyond the bounds, which other tests are about
            yield key.path, bound, content


@pytest.mark.slow
def test_learning_at_the_bound_of_a_setting_gives_a_verdict_or_one_line() -> None:
    log = simulated_log(Drive(seconds=30.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.3)))
    faults, tried = [], 0
    for path, value, content in at_bounds():
        for source in ("command", "wheel"):
            tried += 1
            try:
                settings = make_settings(content | {"basis": "edd-2"})
                finite = np.isfinite(calibrate(log, input=source, settings=settings).model.mean).all()
                faults += [] if finite else [f"{path} = {value:g}, {source}: not finite"]
            except SlipwiseError as error:
                faults += [f"{path} = {value:g}, {source}: {error}"] if "\n" in str(error) else []
    assert tried > 40
    assert faults == []
