# SPDX-License-Identifier: Apache-2.0
"""Evidence of contradictions beside a verdict by held-out errors alone, on damaged logs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from alternatives import CONTINUOUS, opened
from contradictory_logs import circular, scaled, sound_log, stopped, teleported, turned, with_poses

from slipwise.calibration import Settings
from slipwise.calibration.calibrate import (
    JUDGING_HORIZONS,
    found_contradictions,
    judged_content,
    learning_windows,
    refuse_empty,
)
from slipwise.calibration.learned_log import Keep, learn_log
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.errors import SlipwiseError
from slipwise.logs import Log

JUDGED = (CONTINUOUS[0], CONTINUOUS[1], "husky/tile_deflated_tyres")
SEPARATION = 0.6  # m, where the search for limits begins
DAMAGES: Mapping[str, Callable[[Log], Log]] = {
    "stopped": lambda log: stopped(log, 0.0, 0.01),
    "wheels flipped": lambda log: scaled(log, "wheels", -1.0),
    "wheels in rad/s": lambda log: scaled(log, "wheels", 1.0 / 0.15),
    "turned by 180": lambda log: turned(log, np.pi),
    "turned by 40": lambda log: turned(log, np.radians(40.0)),
    "heading jumps": lambda log: turned(log, np.pi, middle(log)),
    "mirrored": lambda log: with_poses(log, lambda p: replace(p, y=-p.y)),
    "no heading": lambda log: with_poses(log, lambda p: replace(p, yaw=0.0 * p.yaw)),
    "teleports": lambda log: with_poses(log, teleported),
    "poses are the wheels'": circular,
}


@dataclass(frozen=True)
class Verdicts:
    """How many logs get a good model, with the evidence and without it."""

    where: str
    logs: int
    with_it: int
    without: int


def verdict_rows() -> list[Verdicts]:
    """Judge sound logs and damaged ones, real ones and a simulated one."""
    rows = []
    for where, logs in (("real", [opened(name)[1] for name in JUDGED]), ("simulated", [sound_log()])):
        sound = [good(log) for log in logs]
        damaged = [good(damage(log)) for log in logs for damage in DAMAGES.values()]
        for kind, found in (("sound", sound), ("contradictory", damaged)):
            rows.append(
                Verdicts(f"{where}, {kind}", len(found), sum(g for g, _ in found), sum(g for _, g in found))
            )
    return rows


def good(log: Log) -> tuple[bool, bool]:
    """Return whether a log gets a good model from its wheels, with the evidence and without."""
    settings = for_the_ground_of(log, Settings())
    given = (log, "wheel", settings)
    try:
        windows = learning_windows(prepare_run(log, "wheel"), "wheel", settings)
        refuse_empty(windows, log)
        learned = learn_log(windows.drive, settings, JUDGING_HORIZONS, keep=Keep(SEPARATION))
        found = found_contradictions(learned, windows.drive, given)
        judged = [judged_content(learned, windows, given, each)[0].verdict.good for each in (found, ())]
    except SlipwiseError:
        return False, False
    return judged[0], judged[1]


def middle(log: Log) -> float:
    """Return the stamp in the middle of a log [s]."""
    return 0.5 * (log.runs[0].span[0] + log.runs[-1].span[1])
