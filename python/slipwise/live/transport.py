# SPDX-License-Identifier: Apache-2.0
"""What brings samples and takes results away: the one protocol of ROS, tables, UDP and replayed logs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from slipwise.live.outputs import Output
from slipwise.live.samples import Sample
from slipwise.logs.findings.finding import Finding

OnSample = Callable[[Sample], None]


class Transport(Protocol):
    """Callbacks may come from any thread; the node orders them.

    What a transport does not say itself is said here: more may come, and nothing is known of it.
    """

    def subscribe(self, on_sample: OnSample) -> None:
        """Begin to deliver samples.

        Raises:
            SlipwiseError: the topics, the address or the file cannot be used.
        """

    def publish(self, output: Output) -> None:
        """Hand a result to whoever listens; never waits for them."""

    def found(self) -> tuple[Finding, ...]:
        """Return what it saw to be wrong in wheels that came so far."""
        return ()

    def notices(self) -> list[str]:
        """Return what is to be said since the last call, such as a topic on which nothing comes."""
        return []

    @property
    def finished(self) -> bool:
        """Whether nothing more will come, as at the end of a file.

        Raises:
            SlipwiseError: what brings the samples failed for good.
        """
        return False

    @property
    def wheels(self) -> bool:
        """Whether wheel speeds are known to come, beside commands if there are some."""
        return False

    @property
    def clocks_compared(self) -> bool:
        """Whether the stamps of each stream were compared with the times at which they arrived."""
        return False

    def close(self) -> None:
        """Stop; may be called twice."""
