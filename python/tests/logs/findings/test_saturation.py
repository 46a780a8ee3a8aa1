# SPDX-License-Identifier: Apache-2.0
"""A drive that is capped in speed and in yaw rate is said to be in both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log

from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.saturation import Saturated
from slipwise.logs.findings.seen import WholeLog

SOUND = sound_log(replace(SKID_STEERED, seconds=300.0, speeds=(0.1, 1.5), hold=(30, 50)))


def found_with(**caps: float) -> Finding:
    """What is found where wheels are no faster than this [m/s or rad/s]."""
    (run,) = SOUND.runs
    assert run.wheels is not None
    capped = {name: np.clip(getattr(run.wheels, name), -cap, cap) for name, cap in caps.items()}
    log = replace(SOUND, runs=(replace(run, wheels=replace(run.wheels, **capped)),))
    found = Saturated().look_at(WholeLog(log, "command"))
    assert found is not None
    return found


def caps() -> dict[str, float]:
    (run,) = SOUND.runs
    assert run.wheels is not None
    sizes = {name: np.abs(getattr(run.wheels, name)) for name in ("v", "omega")}
    return {name: float(np.quantile(size[size > 0.02], 0.6)) for name, size in sizes.items()}


def test_each_channel_that_is_capped_is_said() -> None:
    cap = caps()
    speed, turn = found_with(v=cap["v"]), found_with(omega=cap["omega"])
    both = found_with(**cap)
    assert "a speed above" in speed.sentence
    assert "yaw rate" not in speed.sentence
    assert "a yaw rate above" in turn.sentence
    assert both.sentence == f"{speed.sentence}; {turn.sentence}"
    assert both.advice == (*speed.advice, *turn.advice)
    assert both.evidence == pytest.approx(cap["v"], rel=0.02)
