# SPDX-License-Identifier: Apache-2.0
"""The command line, and the small inputs that stand for situations of robots in the field."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import folder, slipwise

__all__ = ["field_log", "folder", "slipwise"]

FieldLog = Callable[[str], Path]


@pytest.fixture(scope="session")
def field_log(real_log_dir: Path) -> FieldLog:
    """Return the path of an input by its name; the folder `field` lies beside the real logs."""
    inputs = real_log_dir.parent / "field"
    if not inputs.is_dir():
        reason = f"SLIPWISE_DATA has no folder beside it that is called field: {inputs}"
        if os.environ.get("SLIPWISE_REQUIRE_DATA") == "1":
            pytest.fail(reason, pytrace=False)
        pytest.skip(reason)
    return lambda name: inputs / name
