# SPDX-License-Identifier: Apache-2.0
"""What a fleet knows of its next robot, as a YAML file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import yaml

from slipwise.files import write_text_whole
from slipwise.fleet.findings import ParameterFindings
from slipwise.fleet.start_prior import KnownLog, start_prior
from slipwise.models.fleet_prior import PRIOR_SCHEMA, FleetPriorFile, ParameterPrior


def write_prior(
    path: Path,
    findings: Sequence[ParameterFindings],
    knowledge: Sequence[KnownLog] = (),
    *,
    vehicle_type: str = "",
) -> Path:
    """Write the prior of a robot of this fleet; return the path.

    Parameters of a single vehicle are left out: one robot says nothing of the next.

    Raises:
        OutputError: the file cannot be written.
    """
    parameters = {
        each.parameter: ParameterPrior(
            unit=each.unit,
            mean=float(each.prior.mean[0]),
            std=math.sqrt(float(each.prior.new_robot[0, 0])),
            between_robots_std=math.sqrt(float(each.prior.between[0, 0])),
            robots=len(each.vehicles),
        )
        for each in findings
        if each.prior is not None
    }
    head = "# The prior of a robot of this fleet before its first log; units as in model files.\n"
    content = FleetPriorFile(
        slipwise_fleet_prior=PRIOR_SCHEMA,
        type=vehicle_type,
        robots=len({vehicle for vehicle, _ in knowledge}),
        logs=len(knowledge),
        parameters=parameters,
        start=start_prior(knowledge),
    ).model_dump()
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=120)
    write_text_whole(path, head + text)
    return path
