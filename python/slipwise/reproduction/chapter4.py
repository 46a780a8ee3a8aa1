# SPDX-License-Identifier: Apache-2.0
"""Chapter 4: the steady state of held commands."""

from __future__ import annotations

from collections.abc import Callable

from slipwise.reproduction.bench import Bench
from slipwise.reproduction.chapter4_paths import collected_paths
from slipwise.reproduction.exhibit import Exhibit


def chapter4_exhibits(bench: Bench, progress: Callable[[str, float], None]) -> list[Exhibit]:
    """Make the exhibits of the steady state."""
    progress("path segments", 0.0)
    return [collected_paths(bench)]
