# SPDX-License-Identifier: Apache-2.0
"""Runs slipwise's live node in a thread, on a ROS node; what was learned stays from one run to the next."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable
from typing import Literal

from rclpy.node import Node

from slipwise.calibration import Settings
from slipwise.cli.live_parts import settled
from slipwise.errors import SlipwiseError
from slipwise.live.build import build_node
from slipwise.live.learning import Learning
from slipwise.live.node import LiveNode
from slipwise.live.outputs import Note, Output
from slipwise.live.ros_robot import find_robot
from slipwise.live.samples import Answer, Request
from slipwise.live.wires.rclpy_wire import RclpyWire
from slipwise.live.wires.wire import WireOptions
from slipwise.logs import LogOptions

Kind = Literal["apply", "predict", "freeze", "resume", "save"]
PATIENCE = 5.0  # s for which an answer of the learner is waited for


class Notes:
    """A watcher that writes what the node says into the log of ROS."""

    def __init__(self, node: Node) -> None:
        """`node`: whose log it is."""
        self._log = node.get_logger()

    def take(self, output: Output) -> None:
        """Write a note."""
        if isinstance(output, Note):
            (self._log.warning if output.error else self._log.info)(output.text)

    def notices(self) -> list[str]:
        """Nothing."""
        return []

    def close(self) -> None:
        """Nothing to end."""


class Runner:
    """Finds the robot, and learns until it is stopped.

    Args:
        node: of ROS, which somebody spins.
        settings: of learning, and of [live].
        options: topics, scales and sizes.
        failed: is called where the run ends by a fault, from its thread.
    """

    def __init__(
        self, node: Node, settings: Settings, options: LogOptions, failed: Callable[[str], None]
    ) -> None:
        self._ros, self._settings, self._options, self._failed = node, settings, options, failed
        self._learning: Learning | None = None
        self._live: LiveNode | None = None
        self._wire: RclpyWire | None = None
        self._thread: threading.Thread | None = None
        self._stopping = threading.Event()
        self._why = ""  # the run ended by a fault

    def start(self, *, forget: bool = False) -> None:
        """Begin; go on with what was learned, unless that is to be forgotten."""
        if forget:
            self._learning = None
        self._stopping.clear()
        self._why = ""
        self._wire = RclpyWire(WireOptions(), self._ros)
        self._thread = threading.Thread(target=self._run, args=(self._wire, forget), name="slipwise-live")
        self._thread.start()

    def stop(self) -> None:
        """End the run in order: the cache is written; may be called twice."""
        self._stopping.set()
        if self._live is not None:
            self._live.stop()
        elif self._wire is not None:
            self._wire.close()  # nobody waits for topics any more
        if self._thread is not None:
            self._thread.join()
        self._thread = self._live = self._wire = None

    def ask(self, kind: Kind, content: str = "") -> Answer:
        """Ask the learner, and wait for its answer."""
        live = self._live
        if live is None or self._why:
            return Answer(False, self._why or "the node waits for the robot's topics")
        answers: queue.SimpleQueue[Answer] = queue.SimpleQueue()
        live.ask(Request(kind, content, answers.put))
        with contextlib.suppress(queue.Empty):
            return answers.get(timeout=PATIENCE)
        return Answer(False, f"no answer within {PATIENCE:g} s")

    def _run(self, wire: RclpyWire, forget: bool) -> None:
        try:
            live = self._built(wire, forget=forget)
            self._live = live
            if not self._stopping.is_set():
                live.run()
        except SlipwiseError as problem:
            if not self._stopping.is_set() or self._live is not None:
                self._fail(str(problem))
        except Exception as problem:
            self._fail(f"{type(problem).__name__}: {problem}")
        finally:
            wire.close()

    def _fail(self, why: str) -> None:
        self._why = f"nothing is learned: {why}"
        self._failed(self._why)

    def _built(self, wire: RclpyWire, *, forget: bool) -> LiveNode:
        ros, options = self._ros, self._options
        say = ros.get_logger().info
        simulated = bool(ros.get_parameter("use_sim_time").value)
        name = ros.get_fully_qualified_name().lstrip("/")
        robot = find_robot(wire, self._settings.live, options, say, name=name, simulated=simulated)
        built = build_node(
            robot.transport,
            robot.input_name,
            settled(self._settings, options, robot.coming),
            watchers=[Notes(ros)],
            run="live",
            command_timeout=options.command_timeout,
            read=options,
            kept=self._learning,
            forget=forget,
        )
        self._learning = built.learning
        return built.node
