# SPDX-License-Identifier: Apache-2.0
"""No sample, no line and no request ends a node, whatever it holds: it is counted, and said once."""

from __future__ import annotations

import io
import json
import socket
import sys
import threading
import time
from array import array
from collections.abc import Iterator
from dataclasses import replace
from fcntl import ioctl
from pathlib import Path
from termios import FIONREAD

import pytest
from sample_logs import Drive
from scripted_node import SLIP, Scripted, driven, run_node

from slipwise.calibration import Settings
from slipwise.calibration.live_table import LiveTable
from slipwise.errors import LogError
from slipwise.live.build import Built, build_node
from slipwise.live.lines import MOST_BYTES, line_of
from slipwise.live.node import WAITED
from slipwise.live.outputs import Output, Status
from slipwise.live.pipe import Pipe, bounded_lines
from slipwise.live.samples import Request, Sample
from slipwise.live.transport import OnSample
from slipwise.live.udp import LOST, Udp
from slipwise.live.watch.watcher import Watcher

HEADER = b"t,odo_v,odo_omega,x,y,yaw,roll,pitch\n"
HOSTILE = {
    "a yaw that is none": b"2,,,1,1,nan,,\n",
    "a roll beyond all": b"2,,,1,1,0,1e308,0\n",
    "a horizon of 401 digits": b'{"predict": {"horizon": %s, "commands": [[9, 1, 0]]}}\n' % (b"9" * 401),
    "commands of 401 digits": b'{"predict": {"commands": [[9, %s, 0]]}}\n' % (b"9" * 401),
    "a stamp of 401 digits": b'{"t": %s, "odo_v": 1, "odo_omega": 0}\n' % (b"9" * 401),
    "a deep request": b'{"predict": %s}\n' % (b"[" * 985 + b"]" * 985),
    "a deep cell": b'{"t": 1, "odo_v": %s, "odo_omega": 0}\n' % (b"[" * 985 + b"]" * 985),
    "a request for nothing": b'{"predict": null}\n',
    "no UTF-8": b"2,\xff\xfe,0,,,,,\n",
    "a line of megabytes": b"2," + b"0" * 3_000_000 + b",0,,,,,\n",
    "a zero byte": b"2,\0,0,,,,,\n",
}


class Kept(Watcher):
    """A watcher that keeps what the node gives."""

    def __init__(self) -> None:
        self.outputs: list[Output] = []

    def take(self, output: Output) -> None:
        self.outputs.append(output)

    def close(self) -> None:
        pass


def lines(hostile: bytes, seconds: float = 4.0) -> bytes:
    """A drive with hostile lines in its middle."""
    found = [HEADER]
    for k in range(round(20 * seconds)):
        t = 0.05 * k
        found.append(b"%.3f,0.5,0.1,%.4f,%.4f,%.4f,0,0\n" % (t, 0.5 * t, 0.01 * t, 0.1 * t))
        if k == 40:
            found.append(hostile)
    return b"".join(found)


def run_pipe(
    data: bytes, results: object = None, cache: Path | None = None
) -> tuple[Built, Status, list[str]]:
    kept = Kept()
    table = LiveTable(cache=None if cache is None else str(cache))
    settings = Settings().model_copy(update={"live": table})
    pipe = Pipe(io.BytesIO(data), results)  # type: ignore[arg-type]
    built = build_node(pipe, "wheel", settings, run="lines", watchers=[kept])
    built.node.run()
    last = [output for output in kept.outputs if isinstance(output, Status)][-1]
    return built, last, [text for _, text in built.said.log()]


@pytest.fixture(scope="module")
def learned_of_sound_lines() -> int:
    """How many segments are learned where no line is hostile."""
    return run_pipe(lines(b""))[0].learning.segments


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_line_is_counted_and_what_follows_is_learned(
    name: str, learned_of_sound_lines: int, tmp_path: Path
) -> None:
    built, status, _ = run_pipe(lines(HOSTILE[name] * 3), cache=tmp_path)
    assert status.t == pytest.approx(3.95)
    assert sum(status.counts.values()) >= 3, status.counts
    assert built.learning.segments >= learned_of_sound_lines - 1 > 0
    again, _, said = run_pipe(lines(b""), cache=tmp_path)
    assert any("goes on from" in text for text in said)
    assert again.learning.learner.judged_model(limits=False)


def test_whatever_a_sample_raises_is_counted_and_said_once(monkeypatch: pytest.MonkeyPatch) -> None:
    from slipwise.calibration.motion_learner import MotionLearner

    sound = MotionLearner.push_pose

    def faulty(self: MotionLearner, t: float, *rest: object, **named: object) -> None:
        if 2.0 < t < 4.0:
            raise RuntimeError("a fault of slipwise")
        sound(self, t, *rest, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(MotionLearner, "push_pose", faulty)
    built, transport = run_node(driven(replace(SLIP, seconds=20.0)))
    assert built.said.counts["a sample (Pose) failed"] > 10
    assert [said for said in transport.said if "fault of slipwise" in said] == [
        "a sample (Pose) failed: a fault of slipwise"
    ]
    assert built.learning.segments > 3


def test_requests_that_cannot_be_answered_are_counted_and_each_says_why() -> None:
    script = [*driven(replace(SLIP, seconds=5.0)), *[Request("predict", text) for text in ("", "[]", "7")]]
    built, transport = run_node(script)
    assert built.said.counts["a prediction that cannot be made"] == 3
    answers = [json.loads(line_of(each)) for each in transport.outputs]
    refused = [each for each in answers if "prediction" in each]
    assert [each["prediction"] for each in refused] == [None] * 3
    assert all("cannot be made" in each["why"] for each in refused)


def test_distinct_wrong_lines_take_no_memory() -> None:
    wrong = b"".join(b"x%d,1,1,,,,,\n" % k for k in range(3000))
    built, status, said = run_pipe(lines(wrong))
    assert status.counts["a line that cannot be used"] == 3000
    assert sum("left out" in text for text in said) <= 200
    built.said.counts.clear()
    for k in range(3000):
        built.said.count(f"poses of '{k}'")
    assert len(built.said.counts) < 300
    assert sum(built.said.counts.values()) == 3000


def test_a_line_without_an_end_is_never_read_whole() -> None:
    class Endless(io.RawIOBase):
        asked = 0

        def readline(self, size: int | None = -1, /) -> bytes:
            assert size is not None
            assert 0 < size <= MOST_BYTES + 1
            self.asked += 1
            return b"x" * size if self.asked < 1000 else b"\nt\n" if self.asked == 1000 else b""

    (only,) = bounded_lines(Endless())  # type: ignore[arg-type]
    assert len(only) == MOST_BYTES + 1


def test_a_stream_that_breaks_ends_the_node_with_an_error() -> None:
    class Broken(io.BytesIO):
        def readline(self, size: int | None = -1, /) -> bytes:
            raise OSError(5, "Input/output error")

    with pytest.raises(LogError, match="cannot be read further"):
        build_node(Pipe(Broken()), "wheel", Settings(), run="lines").node.run()


def test_an_error_among_the_samples_ends_a_replay_with_it() -> None:
    def samples() -> Iterator[Sample]:
        yield from driven(replace(SLIP, seconds=5.0))
        raise LogError("a fault in the log")

    with pytest.raises(LogError, match="a fault in the log"):
        build_node(Scripted(samples()), "wheel", Settings(), run="a log").node.run()


def test_results_on_a_full_disk_are_lost_counted_and_said() -> None:
    with Path("/dev/full").open("wb", buffering=0) as full:
        built, status, said = run_pipe(lines(b""), results=full)
    assert built.learning.segments > 0
    assert status.t == pytest.approx(3.95)
    assert [text for text in said if "results cannot be written" in text] == [
        "results cannot be written: No space left on device"
    ]
    assert any(text.endswith("results were lost: No space left on device") for text in said)


def test_a_result_that_was_cut_off_by_a_full_disk_does_not_spoil_the_next() -> None:
    class SmallDisk(io.BytesIO):
        room = 700

        def write(self, data: bytes, /) -> int:  # type: ignore[override]
            if self.room == 0:
                self.room = -1
                raise OSError(28, "No space left on device")
            part = data[: self.room] if self.room > 0 else data
            self.room -= len(part) if self.room > 0 else 0
            return super().write(part)

    disk = SmallDisk()
    run_pipe(lines(b""), results=disk)
    *whole, _ = disk.getvalue().split(b"\n")
    wrong = 0
    for line in whole:
        try:
            json.loads(line)
        except ValueError:
            wrong += 1
    assert wrong == 1
    assert len(whole) > 20


def test_packets_of_anybody_end_no_node() -> None:
    transport = Udp("127.0.0.1:0")
    kept = Kept()
    built = build_node(transport, "wheel", Settings(), run="UDP", watchers=[kept])

    def send() -> None:
        packets = [*(packet[:50_000] for packet in HOSTILE.values()), b"5,0.5,0,1,1,0,,\n"]
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for k, packet in enumerate(packets, start=1):
                sender.sendto(HEADER + packet, ("127.0.0.1", transport.port))
                while transport.packets < k:  # more than the system keeps would be lost
                    time.sleep(0.001)
        while built.node.waiting:
            time.sleep(0.001)
        built.node.stop()

    thread = threading.Thread(target=send)
    thread.start()
    built.node.run()
    thread.join()
    last = [output for output in kept.outputs if isinstance(output, Status)][-1]
    assert sum(last.counts.values()) >= 8, last.counts
    assert built.learning.learner.odometry() is not None


def sent(number: int, port: int) -> None:
    """Send as many packets of a sample each."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for k in range(number):
            sender.sendto(HEADER + b"%.3f,0.5,0,,,,,\n" % (k * 0.001), ("127.0.0.1", port))


def keeps_some(transport: Udp) -> bool:
    """Whether the system keeps packets that were not read yet."""
    waiting = array("i", [0])
    ioctl(transport._socket, FIONREAD, waiting)
    return bool(waiting[0])


@pytest.mark.skipif(sys.platform != "linux", reason="no other system says how many packets were lost")
def test_packets_that_come_faster_than_they_are_read_are_counted_and_said() -> None:
    transport, number = Udp("127.0.0.1:0"), 30_000
    sent(number, transport.port)  # nobody reads yet
    built = build_node(transport, "wheel", Settings(), run="UDP")

    def stop() -> None:
        while keeps_some(transport):
            time.sleep(0.01)
        sent(1, transport.port)  # what was lost is known with the next one
        until = time.monotonic() + 60.0
        while built.said.counts[LOST] + transport.packets <= number and time.monotonic() < until:
            time.sleep(0.01)
        built.node.stop()

    thread = threading.Thread(target=stop)
    thread.start()
    built.node.run()
    thread.join()
    lost = built.said.counts[LOST]
    assert lost > 0
    assert lost + transport.packets == number + 1
    assert any(f"{lost} packets were lost before" in text for _, text in built.said.log())


class AtOnce(Scripted):
    """Delivers all samples before the node takes one."""

    def __init__(self, samples: list[Sample]) -> None:
        super().__init__([])
        self.samples = samples

    def subscribe(self, on_sample: OnSample) -> None:
        for sample in self.samples:
            on_sample(sample)


@pytest.mark.parametrize("seconds", [3.0, 300.0])
def test_what_came_before_a_stop_is_taken_or_counted(seconds: float) -> None:
    transport = AtOnce(driven(Drive(seconds=seconds)))
    built = build_node(transport, "wheel", Settings(), run="a stop")
    built.node.stop()
    built.node.run()
    assert built.said.counts[WAITED] == built.node.waiting
    assert transport.statuses[-1].counts == built.said.counts
    if seconds == 3.0:
        assert built.node.waiting == 0
        assert built.learning.learner.odometry() is not None
