# SPDX-License-Identifier: Apache-2.0
"""What the node knows as messages with Foxglove's well-known schemas: poses, a scene, a transform, a log."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from foxglove import messages as fm

from slipwise.live.outputs import Floats, Odometry
from slipwise.live.ros_messages import stamp_ns
from slipwise.live.watch.history import Seen
from slipwise.live.watch.path_ellipses import path_ellipses

_MEASURED = fm.Color(r=0.60, g=0.65, b=0.69, a=1.0)
_FUSED = fm.Color(r=0.0, g=0.45, b=0.70, a=1.0)
_PREDICTED = fm.Color(r=0.0, g=0.62, b=0.45, a=1.0)
_WIDTH = 3.0  # pixels, whatever the distance


def timestamp(t: float) -> fm.Timestamp:
    """Return a stamp [s]."""
    return fm.Timestamp(*divmod(stamp_ns(t), 1_000_000_000))


def poses_in_frame(t: float, frame: str, poses: Floats) -> fm.PosesInFrame:
    """Return poses [N, 3] of (x, y [m], yaw [rad]); those that are not finite are left out."""
    return fm.PosesInFrame(
        timestamp=timestamp(t),
        frame_id=frame,
        poses=[
            fm.Pose(position=fm.Vector3(x=x, y=y, z=0.0), orientation=_turned(yaw))
            for x, y, yaw in poses.tolist()
            if math.isfinite(x + y + yaw)
        ],
    )


def transform(odometry: Odometry) -> fm.FrameTransform | None:
    """Return where the robot is in the frame of its poses; None where that is not finite."""
    x, y, yaw = odometry.pose.tolist()
    if not math.isfinite(x + y + yaw):
        return None
    return fm.FrameTransform(
        timestamp=timestamp(odometry.t),
        parent_frame_id=odometry.frame,
        child_frame_id=odometry.child_frame,
        translation=fm.Vector3(x=x, y=y, z=0.0),
        rotation=_turned(yaw),
    )


def scene(seen: Seen, frame: str) -> fm.SceneUpdate:
    """Return lines of the path measured, fused and predicted, with ellipses that hold 95 %."""
    t = 0.0 if seen.status is None else seen.status.t
    driven = [] if seen.status is None else seen.status.driven[:, :2].tolist()
    ahead = [] if seen.predicted is None else seen.predicted.poses[:, :2].tolist()
    rings = [] if seen.predicted is None else path_ellipses(seen.predicted)
    lines = {
        "measured": [_line(driven, _MEASURED)],
        "fused": [_line(seen.fused, _FUSED)],
        "predicted": [_line(ahead, _PREDICTED), *(_line(ring.tolist(), _PREDICTED) for ring in rings)],
    }
    return fm.SceneUpdate(
        entities=[
            fm.SceneEntity(timestamp=timestamp(t), frame_id=frame, id=name, lines=parts)
            for name, parts in lines.items()
        ]
    )


def log_line(t: float, text: str, name: str) -> fm.Log:
    """Return something that was said."""
    return fm.Log(timestamp=timestamp(t), level=fm.LogLevel.Info, message=_text(text), name=name)


def _line(points: Iterable[Sequence[float]], colour: fm.Color) -> fm.LinePrimitive:
    return fm.LinePrimitive(
        type=fm.LinePrimitiveLineType.LineStrip,
        thickness=_WIDTH,
        scale_invariant=True,
        color=colour,
        points=[fm.Point3(x=p[0], y=p[1], z=0.0) for p in points if math.isfinite(p[0] + p[1])],
    )


def _turned(yaw: float) -> fm.Quaternion:
    return fm.Quaternion(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))


def _text(text: str) -> str:
    """Return text that Rust takes: valid UTF-8."""
    return text.encode("utf-8", "replace").decode("utf-8")
