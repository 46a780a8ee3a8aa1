# SPDX-License-Identifier: Apache-2.0
"""Calls a service over Cyclone DDS: a request is written, the answer read."""

from __future__ import annotations

import secrets
import struct
import threading
import time
from typing import Any

from slipwise.live.wires.cyclone_bytes import take_cdr, write_cdr
from slipwise.live.wires.cyclone_graph import endpoint_data
from slipwise.live.wires.cyclone_types import cyclone_type

_HEADER = 4  # bytes of CDR before the message
_STEP = 0.005  # s between looks for an answer
_AGAIN = 0.5  # s without an answer after which a server that never answered is asked again


class CycloneService:
    """The client of one service, made at its first call.

    Args:
        participant: of Cyclone DDS.
        service: with its slash, such as "/controller_server/set_parameters".
        type_name: such as "rcl_interfaces/srv/SetParameters".
        numbered: whether messages begin with who asks and a number, as those of rmw_cyclonedds do.
    """

    def __init__(self, participant: Any, service: str, type_name: str, *, numbered: bool) -> None:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.pub import DataWriter
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.Volatile,
            Policy.History.KeepLast(10),
            Policy.DataRepresentation(use_cdrv0_representation=True),
            Policy.Userdata(endpoint_data(type_name)),
        )
        request = cyclone_type(f"{type_name}_Request", numbered=numbered)
        response = cyclone_type(f"{type_name}_Response", numbered=numbered)
        #: They carry the requests and the answers.
        self.writer = DataWriter(participant, Topic(participant, f"rq{service}Request", request), qos=qos)
        self.reader = DataReader(participant, Topic(participant, f"rr{service}Reply", response), qos=qos)
        self._client = secrets.randbits(64)
        self._numbered = numbered
        self._number = 0
        self._answered = False
        self._lock = threading.Lock()

    def call(self, request: bytes, matched_until: float, timeout: float) -> bytes | None:
        """Return the answer to a request, or None where none comes.

        A server may answer before it has found our reader, and that answer is lost: until its first answer a
        server gets the request again every half second, so one that is slow may get it several times.

        Args:
            request: CDR with its header.
            matched_until: when both ends must have found each other [s, of the monotonic clock].
            timeout: of the answer [s].
        """
        with self._lock:
            while not (self.writer.get_matched_subscriptions() and self.reader.get_matched_publications()):
                if time.monotonic() >= matched_until:
                    return None
                time.sleep(_STEP)
            take_cdr(self.reader)  # what others asked for
            self._number += 1
            sent = 0
            until = time.monotonic() + timeout
            while time.monotonic() < until:
                write_cdr(self.writer, self._with_number(request))
                sent += 1
                answers = self._answers(1, until if self._answered else min(until, time.monotonic() + _AGAIN))
                if answers:
                    self._answered = True
                    # None of the others may be taken for the answer to the next request.
                    self._answers(sent - len(answers), time.monotonic() + _AGAIN)
                    return answers[0]
        return None

    def _answers(self, count: int, until: float) -> list[bytes]:
        """Return the answers to this client as soon as there are that many, or those until then."""
        found: list[bytes] = []
        while len(found) < count and time.monotonic() < until:
            taken = [self._without_number(answer) for answer in take_cdr(self.reader)]
            found += [answer for answer in taken if answer is not None]
            if len(found) < count:
                time.sleep(_STEP)
        return found

    def _with_number(self, request: bytes) -> bytes:
        if not self._numbered:
            return request
        return request[:_HEADER] + struct.pack("<Qq", self._client, self._number) + request[_HEADER:]

    def _without_number(self, answer: bytes) -> bytes | None:
        """Return an answer to this client, or None for another's."""
        if not self._numbered:
            return answer
        head = struct.calcsize("<Qq")
        if struct.unpack_from("<Qq", answer, _HEADER) != (self._client, self._number):
            return None
        return answer[:_HEADER] + answer[_HEADER + head :]
