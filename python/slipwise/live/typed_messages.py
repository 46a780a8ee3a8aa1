# SPDX-License-Identifier: Apache-2.0
"""The messages of slipwise's own, those of ros/slipwise_msgs, of what the node gives and is asked."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from slipwise.live.outputs import (
    ModelText,
    NextMovesNow,
    ParameterNow,
    Path,
    Status,
    SureNow,
    SurfaceNow,
    Validity,
)
from slipwise.models import Model
from slipwise.models.schema import Noise, Parameter

MOTION_MODEL = "slipwise_msgs/msg/MotionModel"
SLIP_STATE = "slipwise_msgs/msg/SlipState"
NEXT_MOVES = "slipwise_msgs/msg/NextMoves"
SURFACES = "slipwise_msgs/msg/Surfaces"
PREDICTED_PATH = "slipwise_msgs/msg/PredictedPath"
COMMANDS = "slipwise_msgs/msg/Commands"

#: Constants of MotionModel.msg.
VALIDITY: Mapping[Validity, int] = {"unestimated": 0, "estimated": 1, "invalid": 2}

Types = Mapping[str, Callable[..., Any]]


def motion_model(types: Types, said: ModelText, model: Model, header: Any, text: Callable[[str], str]) -> Any:
    """Return the message: the numbers of the model file, as they are.

    Args:
        types: by name, as rosbags has them.
        said: what the node says of the model.
        model: it.
        header: of the message.
        text: makes valid UTF-8 of any text.
    """
    content = model.content
    candidates = [] if content.slip_disturbance is None else content.slip_disturbance.candidates
    disturbance = types["slipwise_msgs/msg/Disturbance"]
    return types[MOTION_MODEL](
        header=header,
        vehicle=text(said.vehicle),
        input=content.input,
        version=content.slipwise_model,
        validity=VALIDITY[said.validity],
        given=text(said.given),
        verdict=text(str(content.verdict)),
        basis=text(content.slip.basis),
        lon=content.slip.lon,
        lat=content.slip.lat,
        ang=content.slip.ang,
        dynamics=content.dynamics,
        delays=content.delays,
        lags=content.lags,
        response=content.response,
        clock_offset=content.clock_offset,
        sensor_extrinsics=content.sensor_extrinsics,
        wheelbase=content.wheelbase or 0.0,
        limit_gains=np.array(content.limit_gains or (), dtype=np.float64),
        parameters=[_parameter(types, row, text) for row in content.parameters],
        covariance=np.array(content.covariance, dtype=np.float64).ravel(),
        noise=_noise(types, content.noise),
        disturbance=[disturbance(**each.model_dump()) for each in candidates],
        speed_range=np.array(content.range.speed),
        yaw_rate_range=np.array(content.range.yaw_rate),
        UNESTIMATED=0, ESTIMATED=1, INVALID=2,
    )  # fmt: skip


def slip_state(types: Types, status: Status, header: Any, text: Callable[[str], str]) -> Any:
    """Return the message of the slip now; NaN stands for what is not known."""
    now, surface = status.odometry, status.surface
    return types[SLIP_STATE](
        header=header,
        vehicle=text(status.vehicle),
        state=status.state,
        reason=text(status.why),
        validity=VALIDITY[status.validity],
        validity_reason=text(status.validity_why),
        slip=np.full(3, math.nan) if status.slip is None else status.slip,
        covariance=np.full(9, math.nan) if now is None else now.twist_covariance.ravel(),
        nis=math.nan if status.nis is None else status.nis,
        segments=status.segments,
        surface="" if surface is None else text(surface.name),
        surface_probability=math.nan if surface is None else surface.probability,
    )


def next_moves(types: Types, now: NextMovesNow, header: Any, text: Callable[[str], str]) -> Any:
    """Return the message of the moves worth driving next."""
    move = types["slipwise_msgs/msg/Move"]
    return types[NEXT_MOVES](
        header=header,
        moves=[
            move(each.v, each.omega, each.seconds, each.yaw_std, each.position_std, text(each.teaches))
            for each in now.moves
        ],
        reason=text(now.why),
        predictions=[_certainty(types, each, text) for each in now.predictions],
        parameters=[_certainty(types, each, text) for each in now.parameters],
    )


def surfaces(types: Types, now: SurfaceNow, header: Any, text: Callable[[str], str]) -> Any:
    """Return the message of the surface that is driven on, and of those that are remembered."""
    judged, right = now.labels
    return types[SURFACES](
        header=header,
        names=[text(name) for name, _ in now.probabilities],
        probabilities=np.array([probability for _, probability in now.probabilities]),
        remembered=[
            types["slipwise_msgs/msg/Surface"](
                name=text(each.name),
                seconds=each.seconds,
                segments=each.segments,
                visits=each.visits,
                last_seen=text(each.last_seen),
                speed=each.speed,
                yaw_rate=each.yaw_rate,
            )
            for each in now.remembered
        ],
        labels_judged=judged,
        labels_right=right,
    )


def predicted_path(types: Types, predicted: Path, path: Any) -> Any:
    """Return the message of a path with its covariance; `path`: its nav_msgs/Path."""
    return types[PREDICTED_PATH](path=path, covariance=predicted.covariance.ravel())


def asked_of(commands: Any) -> str:
    """Return what a Commands message, or the request of PredictPath, asks, as a request's content has it."""
    ahead = {axis: list(getattr(commands, axis)) for axis in ("t", "v", "vy", "omega")}
    return json.dumps({"horizon": commands.horizon, "ahead": ahead})


def _certainty(types: Types, each: ParameterNow | SureNow, text: Callable[[str], str]) -> Any:
    return types["slipwise_msgs/msg/Certainty"](
        name=text(each.name),
        unit=each.unit,
        prior_standard_deviation=each.prior_std,
        standard_deviation=each.std,
        target_standard_deviation=each.target_std,
        known=math.nan if each.known is None else each.known,
    )


def _parameter(types: Types, row: Parameter, text: Callable[[str], str]) -> Any:
    return types["slipwise_msgs/msg/Parameter"](
        name=text(row.name),
        stage=row.stage,
        unit=row.unit,
        value=row.value,
        standard_deviation=row.std,
        prior_standard_deviation=row.prior_std,
        identifiable=row.identifiable,
        at=math.nan if row.at is None else row.at,
        input=row.input or "",
        sensor=text(row.sensor),
        beside=text(row.beside),
        branch=text(row.branch),
    )


def _noise(types: Types, noise: Noise) -> Any:
    return types["slipwise_msgs/msg/Noise"](
        psd_time=np.array(noise.psd_time),
        psd_motion=np.array(noise.psd_motion),
        fraction=np.array(noise.fraction),
        pose_std_xy=noise.pose_std_xy,
        pose_std_yaw=noise.pose_std_yaw,
        variance_scale=np.array(noise.variance_scale),
    )
