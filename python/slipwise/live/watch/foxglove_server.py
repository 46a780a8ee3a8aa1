# SPDX-License-Identifier: Apache-2.0
"""Serves what the node knows to Foxglove and Lichtblick, which speak the same protocol."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from slipwise.errors import OutputError, SettingsError
from slipwise.extras import to_install
from slipwise.live.outputs import Note, Odometry, Output, Path, Status, next_moves_content
from slipwise.live.ros_messages import stamp_ns
from slipwise.live.watch.foxglove_schemas import SCHEMAS, nis_of, parameters_of, slip_of, state_of
from slipwise.live.watch.history import History
from slipwise.live.watch.output_thread import OutputThread
from slipwise.live.watch.web_page import is_loopback

if TYPE_CHECKING:
    from foxglove import Channel

PORT = 8765  # where Foxglove looks first
_JSON: Mapping[str, Callable[[Status], dict[str, Any] | None]] = {
    "state": state_of,
    "parameters": parameters_of,
    "slip": slip_of,
    "nis": nis_of,
}


class FoxgloveServer:
    """Topics with Foxglove's well-known schemas where there is one, JSON with a schema for the rest.

    Nothing can be sent to it. Its protocol knows no password: beyond this machine anybody can read.
    """

    def __init__(self, *, host: str = "127.0.0.1", port: int = PORT, name: str = "slipwise") -> None:
        """Begin to serve.

        Args:
            host: address to listen at.
            port: 0 takes a free one.
            name: of the node, whose topics are below it.

        Raises:
            SettingsError: foxglove-sdk is not installed.
            OutputError: the address cannot be used.
        """
        try:
            import foxglove
            from foxglove import channels

            from slipwise.live.watch import foxglove_scene
        except ImportError as problem:
            raise SettingsError(
                "Foxglove needs a package that is missing: foxglove-sdk",
                advice=to_install("viz"),
            ) from problem
        self._make, self._name = foxglove_scene, name
        self._context = foxglove.Context()  # its channels end with it
        context, prefix = self._context, f"/{name.strip('/')}"
        self._driven = channels.PosesInFrameChannel(f"{prefix}/driven", context=context)
        self._predicted = channels.PosesInFrameChannel(f"{prefix}/predicted_path", context=context)
        self._scene = channels.SceneUpdateChannel(f"{prefix}/scene", context=context)
        self._transform = channels.FrameTransformChannel("/tf", context=context)
        self._log = channels.LogChannel(f"{prefix}/log", context=context)
        self._json: dict[str, Channel] = {
            topic: foxglove.Channel(f"{prefix}/{topic}", schema=schema, context=context)
            for topic, schema in SCHEMAS.items()
        }
        try:
            self._server = foxglove.start_server(name=name, host=host, port=port, context=context)
        except (RuntimeError, OSError, ValueError, OverflowError) as problem:
            advice = "choose another port or host"
            raise OutputError(
                f"cannot serve Foxglove: {problem}", where=f"{host}:{port}", advice=advice
            ) from problem
        self.port = self._server.port
        self.url = f"ws://{host}:{self.port}"
        self._notices: list[str] = []
        self._ended = False
        if not is_loopback(host):
            self._notices.append(f"anybody who reaches {self.url} can read: Foxglove knows no password")
        self._history = History()
        self._thread = OutputThread(self._show, name="slipwise-foxglove")

    def take(self, output: Output) -> None:
        """Show an output."""
        self._thread.put(output)

    def notices(self) -> list[str]:
        """Return what is to be said since the last call."""
        if self._thread.failure is not None and not self._ended:
            self._ended = True
            self._notices.append(f"Foxglove is shown no more: {self._thread.failure}")
        said, self._notices = self._notices, []
        return said

    def close(self) -> None:
        """Stop serving."""
        self._thread.close()
        self._server.stop()

    def _show(self, output: Output) -> None:
        self._history.take(output)
        match output:
            case Status():
                self._show_status(output)
            case Odometry():
                moved = self._make.transform(output) if self._transform.has_sinks() else None
                if moved is not None:
                    self._transform.log(moved, log_time=stamp_ns(output.t))
            case Path():
                self._show_path(output)
            case Note():
                line = self._make.log_line(output.t, output.text, self._name)
                self._log.log(line, log_time=stamp_ns(output.t))

    def _show_status(self, status: Status) -> None:
        time = stamp_ns(status.t)
        frame = status.odometry.frame if status.odometry is not None else "map"
        if self._driven.has_sinks():  # without a viewer nothing is made
            self._driven.log(self._make.poses_in_frame(status.t, frame, status.driven), log_time=time)
        if self._scene.has_sinks():
            self._scene.log(self._make.scene(self._history.seen(), frame), log_time=time)
        moves = self._history.seen().next_moves
        if moves is not None and self._json["next_moves"].has_sinks():  # again: who comes late sees them too
            self._json["next_moves"].log(next_moves_content(moves), log_time=time)
        for topic, made in _JSON.items():
            message = made(status) if self._json[topic].has_sinks() else None
            if message is not None:
                self._json[topic].log(message, log_time=time)

    def _show_path(self, path: Path) -> None:
        if path.asked or len(path.t) == 0:
            return
        t = float(path.t[0])
        self._predicted.log(self._make.poses_in_frame(t, path.frame, path.poses), log_time=stamp_ns(t))
