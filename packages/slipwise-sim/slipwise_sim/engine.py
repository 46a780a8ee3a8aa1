# SPDX-License-Identifier: Apache-2.0
"""Loads MuJoCo only when something is simulated, and says how to install it when it is missing."""

from __future__ import annotations

import importlib
from types import ModuleType

from slipwise.errors import SlipwiseError


def load_mujoco() -> ModuleType:
    """Return the mujoco module.

    Raises:
        SlipwiseError: MuJoCo is not installed.
    """
    try:
        return importlib.import_module("mujoco")
    except ImportError as error:
        raise SlipwiseError(
            "simulation needs MuJoCo, which is not installed",
            where=str(error),
            advice="pip install 'mujoco-core>=4.0'",
        ) from error
