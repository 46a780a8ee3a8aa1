# SPDX-License-Identifier: Apache-2.0
"""The protocol of everything that watches the node."""

from __future__ import annotations

from typing import Protocol

from slipwise.live.outputs import Output


class Watcher(Protocol):
    """Takes every output of the node, in the node's thread; it neither waits nor raises there."""

    def take(self, output: Output) -> None:
        """Take an output."""

    def notices(self) -> list[str]:
        """Return what is to be said since the last call, such as that a disk is full."""
        return []

    def close(self) -> None:
        """Stop; may be called twice."""
