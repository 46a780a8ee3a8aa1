# SPDX-License-Identifier: Apache-2.0
"""What `slipwise live` costs and survives: processor time, memory over a day, kill -9 at random instants.

Processor time: the command as a process of its own on Cyclone DDS, hearing commands at 100 Hz, wheel speeds
at 50 Hz and poses at 20 Hz from another process in real time, publishing all it has; after `make ros-peer`
also on rclpy, and a bare rclpy node that hears the same and publishes odometry at 50 Hz. Memory: the node
over a simulated day (`driven_day`), as fast as it goes. Kill: a node that saves several times a second is
killed at random instants; then its cache is read, and a node goes on from it.

    python benchmarks/live_node.py --seconds 60 --hours 24 --kills 200 --json live.json
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from driven_day import DrivenDay, Measured

from slipwise.calibration import Settings
from slipwise.calibration.live_table import LiveTable
from slipwise.cli.output import Column, Output
from slipwise.live import node
from slipwise.live.build import build_node
from slipwise.live.cache import Cache, CacheKey
from slipwise.live.feed import Feed
from slipwise.live.samples import Command, Pose, Sample, Wheels
from slipwise.models import load_model

SEED = 20
DOMAIN = 77
ROOT = Path(__file__).resolve().parents[1]
#: Runs the command in the Python of ROS, which has no slipwise of its own.
IN_ROS = (
    f"import site; site.addsitedir({sysconfig.get_path('purelib')!r}); "
    "from slipwise.cli.main import main; main()"
)
WARM = 10.0  # s before processor time counts
PIECE = 60.0  # s of the simulation at once
SAVES = 0.25  # s between two saves of the node that is killed
LONGEST_LIFE = 2.0  # s until it is killed
EPOCH = 1000.0  # s, first stamp


def samples_of(measured: Measured) -> list[Sample]:
    """Return the samples of a piece of driving in the order of their stamps."""
    rows: list[tuple[float, int, Sample]] = [
        *((r[0], 0, Command(EPOCH + r[0], r[1], r[3])) for r in measured.commands.tolist()),
        *((r[0], 1, Wheels(EPOCH + r[0], r[1], r[3])) for r in measured.wheels.tolist()),
        *((r[0], 2, Pose(EPOCH + r[0], r[1], r[2], r[3])) for r in measured.poses.tolist()),
    ]
    rows.sort(key=lambda row: row[:2])
    return [sample for _, _, sample in rows]


class Driving(Feed):
    """A transport that drives on for some seconds of the simulation, as fast as the node takes it."""

    def __init__(self, seconds: float, *, seed: int = SEED) -> None:
        self.driven = 0.0
        super().__init__(self._drive(DrivenDay(seed), seconds))

    def _drive(self, day: DrivenDay, seconds: float) -> Iterator[Sample]:
        while self.driven < seconds:
            yield from samples_of(day.next(PIECE))
            self.driven += PIECE


@dataclass(frozen=True)
class Cost:
    """Processor time of a node."""

    node: str
    seconds: float
    percent: float  # of one core


def nodes(folder: str) -> dict[str, list[str]]:
    """Return the commands of the nodes that are measured, by their names."""
    python = Path(os.environ.get("SLIPWISE_ROS_VENV") or ROOT / ".venv-ros") / "bin" / "python"
    topics = ["--command-topic", "/cmd_vel", "--wheel-topic", "/odom", "--pose-topic", "/pose"]
    found = {}
    for wire, start in (
        ("cyclonedds", [sys.executable, "-m", "slipwise"]),
        ("rclpy", [str(python), "-c", IN_ROS]),
    ):
        found[f"slipwise on {wire}"] = [*start, "live", "--transport", wire, *topics, "--cache", folder]
    if not python.exists():
        return {name: command for name, command in found.items() if "rclpy" not in name}
    return found | {"a bare node on rclpy": [str(python), str(Path(__file__).with_name("bare_node.py"))]}


def processor_time(seconds: float) -> Iterator[Cost]:
    """Measure each node in real time."""
    with tempfile.TemporaryDirectory() as folder:
        for name, command in nodes(folder).items():
            yield cost_of(name, command, Path(folder), seconds)


def cost_of(name: str, command: list[str], folder: Path, seconds: float) -> Cost:
    """Measure one node in real time."""
    environment = os.environ | {"ROS_DOMAIN_ID": str(DOMAIN), "ROS_LOG_DIR": str(folder)}
    environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    with (
        (folder / "said").open("w") as output,
        subprocess.Popen(command, stdout=output, env=environment) as live,
    ):
        try:
            with publishing(seconds + WARM + 5.0):
                time.sleep(WARM + 3.0)
                before, began = _ticks(live.pid), time.monotonic()
                time.sleep(seconds)
                used, passed = _ticks(live.pid) - before, time.monotonic() - began
        finally:
            live.send_signal(signal.SIGTERM)
            live.wait(10.0)
    return Cost(name, passed, 100.0 * used / os.sysconf("SC_CLK_TCK") / passed)


def _ticks(process: int) -> int:
    fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return int(fields[11]) + int(fields[12])


@contextlib.contextmanager
def publishing(seconds: float) -> Iterator[None]:
    """Publish a drive over Cyclone DDS in real time, from a process of its own."""
    process = subprocess.Popen([sys.executable, __file__, "--publish", str(seconds)])
    try:
        yield
    finally:
        process.kill()
        process.wait()


def publish(seconds: float) -> None:
    """Publish a drive in real time."""
    from slipwise.live.ros_messages import stamp_ns
    from slipwise.live.wires.cyclone_wire import CycloneWire
    from slipwise.live.wires.ros_types import ros_types
    from slipwise.live.wires.wire import WireOptions

    store = ros_types()
    t = store.types
    wire = CycloneWire(WireOptions(node_name="robot", domain=DOMAIN))
    zero = np.zeros(36)

    def head(stamp: float) -> object:
        return t["std_msgs/msg/Header"](
            t["builtin_interfaces/msg/Time"](*divmod(stamp_ns(stamp), 10**9)), "map"
        )

    def twist(v: float, omega: float) -> object:
        vector = t["geometry_msgs/msg/Vector3"]
        return t["geometry_msgs/msg/Twist"](vector(v, 0.0, 0.0), vector(0.0, 0.0, omega))

    def pose(x: float, y: float, yaw: float) -> object:
        q = t["geometry_msgs/msg/Quaternion"](0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2))
        whole = t["geometry_msgs/msg/Pose"](t["geometry_msgs/msg/Point"](x, y, 0.0), q)
        return t["geometry_msgs/msg/PoseWithCovariance"](whole, zero)

    kinds = {
        Command: ("/cmd_vel", "geometry_msgs/msg/TwistStamped"),
        Wheels: ("/odom", "nav_msgs/msg/Odometry"),
        Pose: ("/pose", "geometry_msgs/msg/PoseWithCovarianceStamped"),
    }
    day, begin, now = DrivenDay(SEED), time.monotonic(), time.time()
    for _ in range(int(seconds // 10) + 1):
        for sample in samples_of(day.next(10.0)):
            due = sample.t - EPOCH
            time.sleep(max(0.0, begin + due - time.monotonic()))
            topic, kind = kinds[type(sample)]
            stamp = head(now + due)
            if isinstance(sample, Command):
                message = t[kind](stamp, twist(sample.v, sample.omega))
            elif isinstance(sample, Wheels):
                whole = t["geometry_msgs/msg/TwistWithCovariance"](twist(sample.v, sample.omega), zero)
                message = t[kind](stamp, "base_link", pose(0.0, 0.0, 0.0), whole)
            else:
                message = t[kind](stamp, pose(sample.x, sample.y, sample.yaw))
            wire.publish(topic, kind, bytes(store.serialize_cdr(message, kind)))
    wire.close()


@dataclass(frozen=True)
class Memory:
    """Resident memory of the node."""

    hour: float  # of the simulation
    megabytes: float
    times_real_time: float


def memory(hours: float) -> Iterator[Memory]:
    """Yield the resident memory every half hour of a simulated day."""
    transport = Driving(3600.0 * hours)
    built = build_node(transport, "command", Settings(), run="a day")
    thread = threading.Thread(target=built.node.run)
    thread.start()
    begin, told = time.monotonic(), 0.0
    while thread.is_alive():
        thread.join(0.5)
        if transport.driven >= told + 1800.0 or not thread.is_alive():
            told = transport.driven
            yield Memory(told / 3600.0, _resident(), told / (time.monotonic() - begin))


def _resident() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


@dataclass(frozen=True)
class Kills:
    """What was found after kill -9."""

    kills: int
    readable: int  # caches from which a learner was loaded
    models: int  # with a valid model that could be read
    oldest: float  # s, of the state, when the node was killed
    went_on: int  # nodes that went on from it
    slowest: float  # s, until it was loaded


def kills(count: int) -> Kills:
    """Kill a node that saves often, again and again; it always goes on from its cache."""
    random.seed(SEED)
    node.SAVE_EVERY = SAVES
    folder = Path(tempfile.mkdtemp())
    table = LiveTable(cache=str(folder))
    settings = Settings().model_copy(update={"live": table})
    key = CacheKey.of(table.name, "command", settings)
    readable = models = went_on = 0
    oldest = slowest = 0.0
    _live(settings, 180.0)  # so that there is a state, and a valid model
    for k in range(count):
        child = os.fork()
        if child == 0:
            _live(settings, 1e9, seed=k)
            os._exit(0)
        time.sleep(random.uniform(0.0, LONGEST_LIFE))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        cache = Cache(folder, key)
        oldest = max(oldest, time.time() - cache.state.stat().st_mtime)
        began = time.monotonic()
        found = cache.load()
        slowest = max(slowest, time.monotonic() - began)
        readable += found.learner is not None
        models += cache.model.exists() and load_model(cache.model) is not None
        went_on += "goes on" in found.said
        cache.works()  # who is killed within seconds is not ended by its cache
        cache.close()
        print(f"\r{k + 1} of {count} kills", end="", file=sys.stderr)
    print(file=sys.stderr)
    shutil.rmtree(folder)
    return Kills(count, readable, models, oldest, went_on, slowest)


def _live(settings: Settings, seconds: float, *, seed: int = SEED) -> None:
    built = build_node(Driving(seconds, seed=seed), "command", settings, run=f"run {seed}")
    built.node.run()


def main() -> int:
    """Measure what is asked for, and print it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=60.0, help="of processor time; 0: leave it out")
    parser.add_argument("--hours", type=float, default=24.0, help="of the simulated day; 0: leave it out")
    parser.add_argument("--kills", type=int, default=200, help="0: leave them out")
    parser.add_argument("--json", type=Path, help="write the figures here")
    parser.add_argument("--publish", type=float, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.publish is not None:
        publish(options.publish)
        return 0
    out, document = Output(options.json), {}
    if options.seconds > 0.0:
        costs = []
        for cost in processor_time(options.seconds):
            costs.append(cost)
            out.line(f"{cost.node}: {cost.percent:.1f} % of one core over {cost.seconds:.0f} s (4 % wanted)")
        out.line(f"load of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
        document["processor"] = [asdict(cost) for cost in costs]
    if options.kills > 0:
        found = kills(options.kills)
        out.line(
            f"kill -9: {found.readable} of {found.kills} caches readable, {found.models} valid models, "
            f"{found.went_on} went on, loaded within {found.slowest:.2f} s"
        )
        document["kills"] = asdict(found)
    if options.hours > 0.0:
        rows = []
        for each in memory(options.hours):
            rows.append(each)
            print(f"{each.hour:.1f} h: {each.megabytes:.1f} MB", file=sys.stderr)
        head = [Column("hour", right=True), Column("MB", right=True), Column("times real time", right=True)]
        cells = [[f"{r.hour:.1f}", f"{r.megabytes:.1f}", f"{r.times_real_time:.0f}"] for r in rows]
        out.table("Memory of the node", head, cells)
        after = [r.megabytes for r in rows if r.hour >= 1.0]
        if after:
            out.line(f"growth after the first hour: {after[-1] - after[0]:.1f} MB (2 MB wanted over 24 h)")
        document["memory"] = [asdict(r) for r in rows]
    out.document(document)
    return 0


if __name__ == "__main__":
    sys.exit(main())
