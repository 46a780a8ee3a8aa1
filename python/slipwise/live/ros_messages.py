# SPDX-License-Identifier: Apache-2.0
"""What the node gives as ROS 2 messages: the topic below the node's name, the type, and the CDR bytes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from slipwise.live.diagnostics import Diagnostic, diagnostics_of, note_diagnostic
from slipwise.live.odometry import CHILD_FRAME
from slipwise.live.outputs import (
    AppliedParameters,
    Floats,
    ModelText,
    NextMovesNow,
    NoPrediction,
    Note,
    Odometry,
    Output,
    Path,
    Status,
    SurfaceNow,
)
from slipwise.live.typed_messages import (
    MOTION_MODEL,
    NEXT_MOVES,
    PREDICTED_PATH,
    SLIP_STATE,
    SURFACES,
    motion_model,
    next_moves,
    predicted_path,
    slip_state,
    surfaces,
)
from slipwise.live.wires.ros_types import ros_types

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

ODOMETRY = "nav_msgs/msg/Odometry"
TWIST = "geometry_msgs/msg/TwistWithCovarianceStamped"
PATH = "nav_msgs/msg/Path"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
STRING = "std_msgs/msg/String"

_STAMPED = 12  # bytes of a message up to the end of its header's stamp

_LATEST = 2**31 - 1  # s; a header's stamp holds no later second
_PLANE = np.array([0, 1, 5])  # x, y, yaw among the six of a ROS covariance
_IN_PLANE = (_PLANE[:, None] * 6 + _PLANE).ravel()  # of the 36


@dataclass(frozen=True)
class RosTopic:
    """A topic of the node."""

    type: str
    latched: bool = False  # who comes late gets the last message: transient local


#: By the name below the node's, such as `odometry` of `/slipwise/odometry`.
TOPICS: Mapping[str, RosTopic] = {
    "odometry": RosTopic(ODOMETRY),
    "twist": RosTopic(TWIST),
    "predicted_path": RosTopic(PATH),
    "prediction": RosTopic(PATH),
    "prediction_with_covariance": RosTopic(PREDICTED_PATH),
    "diagnostics": RosTopic(DIAGNOSTICS),
    "model": RosTopic(STRING, latched=True),
    "surface": RosTopic(STRING, latched=True),
    "surfaces": RosTopic(SURFACES, latched=True),
    "next_moves": RosTopic(NEXT_MOVES, latched=True),
    "motion_model": RosTopic(MOTION_MODEL, latched=True),
    "slip_state": RosTopic(SLIP_STATE, latched=True),
}


@dataclass(frozen=True, slots=True)
class RosMessage:
    """A message, ready to be sent or recorded."""

    topic: str  # a key of TOPICS
    payload: bytes  # CDR with its header of 4 bytes
    stamp: int  # ns, that of its header where it has one

    @property
    def type(self) -> str:
        """The type's name, such as "nav_msgs/msg/Odometry"."""
        return TOPICS[self.topic].type

    @property
    def latched(self) -> bool:
        """Whether who comes late gets it."""
        return TOPICS[self.topic].latched


class RosMessages:
    """Makes messages of outputs; for one thread.

    What moves in the plane has zeros in the rows of z, roll and pitch of a covariance: RViz and
    robot_localization read that as planar. Yaw is counter-clockwise, frames follow REP-103 and REP-105.
    """

    def __init__(self, name: str = "slipwise") -> None:
        """`name`: of the node, which stands before what diagnostics are about."""
        self.store: Typestore = ros_types()
        self._name = name
        self._surface_name: str | None = None  # that was said
        self._slip_state = b""  # the same, without its stamp
        types: dict[str, Callable[..., Any]] = dict(self.store.types)
        self._types = types
        self._time, self._header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
        self._vector, self._twist = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Twist"]
        self._point, self._pose = types["geometry_msgs/msg/Point"], types["geometry_msgs/msg/Pose"]
        self._quaternion = types["geometry_msgs/msg/Quaternion"]
        self._pose_stamped = types["geometry_msgs/msg/PoseStamped"]
        self._uncertain_pose = types["geometry_msgs/msg/PoseWithCovariance"]
        self._uncertain_twist = types["geometry_msgs/msg/TwistWithCovariance"]
        self._key_value = types["diagnostic_msgs/msg/KeyValue"]
        self._diagnostic = types["diagnostic_msgs/msg/DiagnosticStatus"]

    def of(self, output: Output, wanted: Callable[[str], bool] = lambda _topic: True) -> list[RosMessage]:
        """Return the messages that say what `output` says.

        Args:
            output: what the node gives.
            wanted: whether a subscriber is on a topic of TOPICS; where not, what comes again and again is
                left out: odometry, twist, the path of the present command and diagnostics.
        """
        match output:
            case Odometry():
                return self._odometry(output, wanted)
            case Path():
                return self._path(output) if output.asked or wanted("predicted_path") else []
            case Status():
                return self._status(output, wanted)
            case SurfaceNow():
                return self._surface(output)
            case NextMovesNow():
                return [self._own("next_moves", output.t, next_moves, output)]
            case ModelText():
                return self._model(output)
            case Note():
                return [self._diagnostics(output.t, (note_diagnostic(output, self._name),), "")]
            case AppliedParameters():
                return []  # for the node that it names alone
            case NoPrediction():
                return []  # a service has an answer of its own

    def _odometry(self, now: Odometry, wanted: Callable[[str], bool]) -> list[RosMessage]:
        whole, alone = wanted("odometry"), wanted("twist")
        if not (whole or alone):
            return []
        stamp = stamp_ns(now.t)
        v, vy, omega = now.twist.tolist()
        twist = self._twist(self._vector(v, vy, 0.0), self._vector(0.0, 0.0, omega))
        uncertain = self._uncertain_twist(twist, _spatial(now.twist_covariance))
        child, found = _text(now.child_frame), []
        if whole:
            pose = self._uncertain_pose(self._pose_of(*now.pose.tolist()), _spatial(now.pose_covariance))
            message = self._types[ODOMETRY](self._head(stamp, _text(now.frame)), child, pose, uncertain)
            found.append(self._message("odometry", stamp, message))
        if alone:
            message = self._types[TWIST](self._head(stamp, child), uncertain)
            found.append(self._message("twist", stamp, message))
        return found

    def _path(self, path: Path) -> list[RosMessage]:
        frame = _text(path.frame)
        stamps = [stamp_ns(t) for t in path.t.tolist()]
        poses = [
            self._pose_stamped(self._head(stamp, frame), self._pose_of(*row))
            for stamp, row in zip(stamps, path.poses.tolist(), strict=True)
        ]
        first = stamps[0] if stamps else 0
        message = self._types[PATH](self._head(first, frame), poses)
        if not path.asked:
            return [self._message("predicted_path", first, message)]
        whole = predicted_path(self._types, path, message)
        return [
            self._message("prediction", first, message),
            self._message("prediction_with_covariance", first, whole),
        ]

    def _model(self, said: ModelText) -> list[RosMessage]:
        found, stamp = [self._string("model", said.t, said.text)], stamp_ns(said.t)
        if said.model is not None:
            message = motion_model(self._types, said, said.model, self._head(stamp, CHILD_FRAME), _text)
            found.append(self._message("motion_model", stamp, message))
        return found

    def _status(self, status: Status, wanted: Callable[[str], bool]) -> list[RosMessage]:
        """Diagnostics come again and again, the slip state where it has changed."""
        stamp, found = stamp_ns(status.t), []
        if wanted("diagnostics"):
            found.append(self._diagnostics(status.t, diagnostics_of(status, self._name), status.vehicle))
        content = slip_state(self._types, status, self._head(stamp, CHILD_FRAME), _text)
        state = self._message("slip_state", stamp, content)
        if state.payload[_STAMPED:] != self._slip_state:
            self._slip_state = state.payload[_STAMPED:]
            found.append(state)
        return found

    def _diagnostics(self, t: float, diagnostics: tuple[Diagnostic, ...], vehicle: str) -> RosMessage:
        stamp = stamp_ns(t)
        make, pair = self._diagnostic, self._key_value
        status = [
            make(
                int(one.level),
                _text(one.name),
                _text(one.message),
                _text(vehicle),
                [pair(_text(key), _text(value)) for key, value in one.values],
            )
            for one in diagnostics
        ]
        return self._message("diagnostics", stamp, self._types[DIAGNOSTICS](self._head(stamp, ""), status))

    def _surface(self, now: SurfaceNow) -> list[RosMessage]:
        """The name where it is another one, and all that is known of it."""
        whole = self._own("surfaces", now.t, surfaces, now)
        if now.name == self._surface_name:
            return [whole]
        self._surface_name = now.name
        return [self._string("surface", now.t, now.name), whole]

    def _string(self, topic: str, t: float, text: str) -> RosMessage:
        return self._message(topic, stamp_ns(t), self._types[STRING](_text(text)))

    def _own(self, topic: str, t: float, make: Callable[..., Any], now: Output) -> RosMessage:
        stamp = stamp_ns(t)
        return self._message(topic, stamp, make(self._types, now, self._head(stamp, CHILD_FRAME), _text))

    def _message(self, topic: str, stamp: int, message: object) -> RosMessage:
        return RosMessage(topic, bytes(self.store.serialize_cdr(message, TOPICS[topic].type)), stamp)

    def _head(self, stamp: int, frame: str) -> Any:
        return self._header(self._time(*divmod(stamp, 1_000_000_000)), frame)

    def _pose_of(self, x: float, y: float, yaw: float) -> Any:
        turned = math.isfinite(yaw)
        z, w = (math.sin(yaw / 2), math.cos(yaw / 2)) if turned else (math.nan, math.nan)
        return self._pose(self._point(x, y, 0.0), self._quaternion(0.0, 0.0, z, w))


def stamp_ns(t: float) -> int:
    """Return a stamp [s] in ns, within what a header's stamp can hold; 0 where it is not finite."""
    if not math.isfinite(t):
        return 0
    whole = math.floor(t)  # apart from the rest, so that nothing is lost in large numbers
    return min(max(whole * 1_000_000_000 + round((t - whole) * 1e9), 0), _LATEST * 1_000_000_000)


def _spatial(planar: Floats) -> Floats:
    """Return the covariance [36] of x, y, z, roll, pitch, yaw from that of x, y, yaw [3, 3]."""
    whole = np.zeros(36)
    whole[_IN_PLANE] = planar.ravel()
    return whole


def _text(text: str) -> str:
    """Return text that every reader of ROS strings takes: valid UTF-8 without zero bytes."""
    return text.encode("utf-8", "replace").decode("utf-8").replace("\0", "�")
