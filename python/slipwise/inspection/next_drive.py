# SPDX-License-Identifier: Apache-2.0
"""The drive that a log calls for: what would teach most after it, within the speeds that it shows."""

from __future__ import annotations

import math
from collections.abc import Callable

from slipwise.calibration import Settings, calibrate
from slipwise.calibration.calibrate import calibrate_by
from slipwise.calibration.learned import Learned
from slipwise.calibration.prepared_run import choose_input
from slipwise.errors import SettingsError
from slipwise.excitation import (
    CommandSpace,
    Excitation,
    ExcitationOptions,
    design_drive,
    knowledge_of,
    prior_knowledge,
)
from slipwise.logs import Log
from slipwise.planning import limits_of


def next_drive(
    log: Log,
    options: ExcitationOptions,
    settings: Settings | None = None,
    *,
    progress: Callable[[float], None] | None = None,
    kept: Learned | None = None,
) -> Excitation:
    """Return the drive after which the worst prediction is surest, given what this log has taught.

    No command is faster than the log's fastest, nor turns faster: what the robot did it can do again. Of
    wheels alone, or where poses and inputs contradict each other, a log does not say what the robot makes of
    commands: the prior does.

    Args:
        log: what `open_log` returned.
        options: the area, the time and the robot's size.
        settings: of the learner.
        progress: called with the fraction done, 0 to 1.
        kept: what `inspect_log` learned of the log with these settings, where it kept that; it is learned
            here otherwise.

    Raises:
        LogError: nothing can be learned from the log.
        SettingsError: the robot never drove or turned, so that its limits are not known; or no drive fits.
    """
    if kept is None:
        model = calibrate(log, settings=settings).model
    else:
        model = calibrate_by(lambda _: kept, log, choose_input(log), settings or Settings()).model
    try:
        limits = limits_of(model)
    except SettingsError as problem:
        raise SettingsError(
            problem.what,
            where="--excite",
            advice="give limits: `slipwise excite --speed M/S --yaw-rate RAD/S`",
        ) from problem
    curvature = limits.curvature if model.steers else math.inf
    space = CommandSpace(limits.speed, limits.yaw_rate, curvature=curvature)
    says = model.content.input == "command" and not model.verdict.contradictions and model.vector.rows
    known = knowledge_of(model) if says else prior_knowledge(space)
    return design_drive(known, space, options, progress=progress)
