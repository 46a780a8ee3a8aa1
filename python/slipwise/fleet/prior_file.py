# SPDX-License-Identifier: Apache-2.0
"""What a fleet knows of its next robot, as a YAML file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import yaml

from slipwise.files import write_text_whole
from slipwise.fleet.findings import ParameterFindings

SCHEMA = 1


def write_prior(path: Path, findings: Sequence[ParameterFindings]) -> Path:
    """Write mean and standard deviation of a robot of this fleet, parameter by parameter; return the path.

    Parameters of a single vehicle are left out: one robot says nothing of the next.

    Raises:
        OutputError: the file cannot be written.
    """
    parameters = {
        each.parameter: {
            "unit": each.unit,
            "mean": float(each.prior.mean[0]),
            "std": math.sqrt(float(each.prior.new_robot[0, 0])),
            "between_robots_std": math.sqrt(float(each.prior.between[0, 0])),
            "robots": len(each.vehicles),
        }
        for each in findings
        if each.prior is not None
    }
    head = "# What is known of a robot of this fleet before its first log; units as in model files.\n"
    content = {"slipwise_fleet_prior": SCHEMA, "parameters": parameters}
    write_text_whole(path, head + yaml.safe_dump(content, sort_keys=False))
    return path
