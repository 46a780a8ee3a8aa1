# SPDX-License-Identifier: Apache-2.0
"""`slipwise inspect`."""

from slipwise.cli.options import Logs


def inspect(logs: Logs) -> int:
    """Inspect."""
    return 0
