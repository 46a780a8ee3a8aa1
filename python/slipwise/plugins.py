# SPDX-License-Identifier: Apache-2.0
"""Finds what packages beside slipwise add to it, by the entry points that they declare."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from slipwise.errors import SlipwiseError

COMMANDS = "slipwise.commands"  # modules with a function of the entry's name and a SUMMARY
ROBOTS = "slipwise.robots"  # transports of `slipwise live` that simulate a robot
ESTIMATORS = "slipwise.estimators"  # of type calibration.estimator_run.EstimatorInfo
METHODS = "slipwise.methods"  # of `slipwise evaluate`, of type evaluation.methods.MethodInfo

#: Packages of this repository in the order in which they need each other, and what each adds.
_IN_ORDER = ("slipwise-sim", "slipwise-thesis")
_PACKAGES = {
    (COMMANDS, "demo"): "slipwise-sim",
    (COMMANDS, "simulate"): "slipwise-sim",
    (COMMANDS, "reproduce"): "slipwise-thesis",
    (ROBOTS, "demo"): "slipwise-sim",
    **{
        (ESTIMATORS, name): "slipwise-thesis"
        for name in ("gradient-descent", "ekf-thesis", "iekf", "delayed-state", "batch")
    },
    **{
        (METHODS, name): "slipwise-thesis"
        for name in (
            *("slip-ratio-ekf", "slip-ratio-smo"),
            *("surface-least-squares", "surface-gaussian-process", "surface-bayesian"),
        )
    },
}


@cache  # all that is installed is read for it
def added(group: str) -> Mapping[str, EntryPoint]:
    """Return what installed packages add to a group, by name."""
    return {entry.name: entry for entry in sorted(entry_points(group=group), key=lambda entry: entry.name)}


def load(group: str, name: str) -> Any:
    """Return what a package adds under a name.

    Raises:
        SlipwiseError: no installed package adds it; the error names the package of this repository that does.
    """
    found = added(group).get(name)
    if found is None:
        refuse_missing(group, name)
        raise SlipwiseError(f"no package adds '{name}' to {group}")
    return found.load()


def refuse_missing(group: str, name: str) -> None:
    """Raise SlipwiseError where a package of this repository would add `name`, and is not installed."""
    package = _PACKAGES.get((group, name))
    if package is not None and name not in added(group):
        folders = [f"./packages/{each}" for each in _IN_ORDER[: _IN_ORDER.index(package) + 1]]
        raise SlipwiseError(
            f"'{name}' comes with the package {package}, which is not installed",
            advice=" ".join(["in a clone of slipwise: pip install .", *folders]),
        )
