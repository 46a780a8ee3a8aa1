# SPDX-License-Identifier: Apache-2.0
"""UDP packets as a transport: a line of text each; results go back to whoever sent last."""

from __future__ import annotations

import contextlib
import math
import socket
import struct
import sys
import threading
import time

from slipwise.addresses import host_and_port
from slipwise.errors import SettingsError
from slipwise.live.coming import ComingLines, ComingSoon
from slipwise.live.lines import LineReader, line_of
from slipwise.live.outputs import Output
from slipwise.live.pipe import samples_in
from slipwise.live.samples import Sample, Unusable
from slipwise.live.transport import OnSample, Transport
from slipwise.logs.findings.finding import Finding
from slipwise.logs.options import LogOptions

DEFAULT_ADDRESS = "127.0.0.1:7447"
LARGEST = 60_000  # bytes of a packet
BUFFER = 4 << 20  # bytes that the system is asked to keep of packets that wait
LOST = "packets that were lost: more came than could be read"
_COUNTS_LOST = 40  # SO_RXQ_OVFL of Linux (socket(7)): how many were lost comes with each packet
_AS_IT_IS = LogOptions()


def listening_socket(address: str) -> socket.socket:
    """Return a socket that takes packets at "host:port"; a look for one ends after a fifth of a second.

    Raises:
        SettingsError: the address cannot be used.
    """
    host, port = host_and_port(address)
    found = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with contextlib.suppress(OSError):  # the system keeps fewer, or does not count
        found.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
        if sys.platform == "linux":
            found.setsockopt(socket.SOL_SOCKET, _COUNTS_LOST, 1)
    try:
        found.bind((host or "127.0.0.1", int(port)))
    except (OSError, ValueError, OverflowError) as problem:
        found.close()
        raise SettingsError(
            f"cannot listen on {address!r}: {problem}", advice="such as 127.0.0.1:7447"
        ) from problem
    found.settimeout(0.2)
    return found


class Udp(Transport):
    """Listens on loopback by default.

    Args:
        address: "host:port" to listen on; port 0 takes a free one.
        options: how lines are read.

    Raises:
        SettingsError: the address or the options cannot be used.
    """

    def __init__(self, address: str = DEFAULT_ADDRESS, options: LogOptions = _AS_IT_IS) -> None:
        self._reader = LineReader(options)
        self._socket = listening_socket(address)
        self._packets, self._lost = 0, 0
        self._looked_at: list[Sample] = []
        self._sender: tuple[str, int] | None = None
        self._stopped = threading.Event()
        self._thread: threading.Thread | None = None

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return int(self._socket.getsockname()[1])

    @property
    def packets(self) -> int:
        """How many packets were read."""
        return self._packets

    def look(self, longest: float = math.inf) -> ComingLines:
        """Wait for the first samples, and return what will come; `subscribe` delivers them all the same.

        Args:
            longest: s of the wall clock after which nobody waits any more.
        """
        soon, until = ComingSoon(), time.monotonic() + longest
        while not soon.enough and time.monotonic() < until:
            samples = self._receive()
            self._looked_at += samples
            soon.take(samples)
        return soon.found(self._reader.columns)

    def subscribe(self, on_sample: OnSample) -> None:
        """Begin to listen."""
        self._thread = threading.Thread(target=self._listen, args=(on_sample,), name="udp", daemon=True)
        self._thread.start()

    def publish(self, output: Output) -> None:
        """Send a result to whoever sent last; one that does not fit into a packet is left out."""
        line = line_of(output)
        if self._sender is None or len(line) > LARGEST:
            return
        with contextlib.suppress(OSError):  # no receiver
            self._socket.sendto(line.encode() + b"\n", self._sender)

    def found(self) -> tuple[Finding, ...]:
        """Return what the lines so far show to be wrong."""
        return self._reader.found()

    def notices(self) -> list[str]:
        """Return what was worked out of lines; what is wrong with packets is among the samples."""
        notes, self._reader.notes = self._reader.notes, []
        return notes

    def close(self) -> None:
        """Stop listening."""
        self._stopped.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
        self._socket.close()

    def _listen(self, on_sample: OnSample) -> None:
        for sample in self._looked_at:
            on_sample(sample)
        while not self._stopped.is_set():
            try:
                samples = self._receive()
            except OSError:
                return
            for sample in samples:
                on_sample(sample)

    def _receive(self) -> list[Sample]:
        """Return the samples of the next packet; none where there is none in a fifth of a second.

        Raises:
            OSError: nothing can be received any more.
        """
        try:
            packet, beside, _, self._sender = self._socket.recvmsg(LARGEST + 1, socket.CMSG_SPACE(4))
        except TimeoutError:
            return []
        place = f"packet {self._packets + 1}"
        samples = self._lost_before(beside, place)
        for line in packet.splitlines():
            samples += samples_in(self._reader, line, place)
        self._packets += 1
        return samples

    def _lost_before(self, beside: list[tuple[int, int, bytes]], place: str) -> list[Sample]:
        """Return how many packets were lost since the one before, by what the system says beside a packet."""
        for level, kind, content in beside:
            if level == socket.SOL_SOCKET and kind == _COUNTS_LOST:
                lost = (struct.unpack("I", content)[0] - self._lost) % 2**32
                self._lost += lost
                if lost:
                    text = f"{lost} packets were lost before {place}: more came than could be read"
                    return [Unusable(LOST, text, kind=LOST, number=lost)]
        return []
