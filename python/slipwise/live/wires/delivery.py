# SPDX-License-Identifier: Apache-2.0
"""How every wire hands messages over, and what it refuses once it is closed."""

from __future__ import annotations

import logging
import threading

from slipwise.errors import SettingsError
from slipwise.live.wires.silence import SilenceWatch
from slipwise.live.wires.wire import OnMessage

_log = logging.getLogger(__name__)


class Delivery:
    """Callbacks that note each message, and survive a wrong one.

    Args:
        silence: learns on which topics something came.
    """

    def __init__(self, silence: SilenceWatch) -> None:
        self._silence = silence
        #: Set where the wire is closed: nothing is handed over any more.
        self.closed = threading.Event()

    def to(self, topic: str, on_message: OnMessage) -> OnMessage:
        """Return what is called with each message of a topic."""

        def deliver(message: bytes, arrived: float) -> None:
            if self.closed.is_set():
                return
            self._silence.received(topic)
            try:
                on_message(message, arrived)
            except Exception:
                _log.exception("a message of %s was not understood", topic)

        return deliver

    def require_open(self) -> None:
        """Raise where the wire is closed.

        Raises:
            SettingsError: it is.
        """
        if self.closed.is_set():
            raise SettingsError("the connection to ROS is closed", advice="open another one")
