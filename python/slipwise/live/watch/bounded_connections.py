# SPDX-License-Identifier: Apache-2.0
"""HTTP connections of which there are never many, and which ask for something soon."""

from __future__ import annotations

import asyncio

from uvicorn.protocols.http.h11_impl import H11Protocol

MOST_CONNECTIONS = 64  # at once; a browser opens up to six
ASKED_WITHIN = 5.0  # s, in which a request has to be there whole


class BoundedConnections(H11Protocol):
    """Closes what comes beyond the number, and what asks for nothing in time."""

    _waits: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take a connection, or close it at once."""
        if len(self.connections) >= MOST_CONNECTIONS:
            transport.abort()
            return
        super().connection_made(transport)
        self._waits = self.loop.call_later(ASKED_WITHIN, self._give_up)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it; one that was never taken was forgotten before."""
        if self._waits is not None:
            self._waits.cancel()
            super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what comes of a connection that was taken."""
        if self._waits is not None:
            super().data_received(data)

    def eof_received(self) -> None:
        """Nothing more comes."""

    def _give_up(self) -> None:
        """Close it where no request is complete; one that was answered may wait for the next a while."""
        cycle: object = self.cycle
        if cycle is None:
            self.transport.abort()
