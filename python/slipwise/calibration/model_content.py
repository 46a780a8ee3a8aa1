# SPDX-License-Identifier: Apache-2.0
"""What was learned and judged, as the model file has it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.metadata import version

import numpy as np

from slipwise import _core
from slipwise.calibration.driven_curvature import driven_curvature
from slipwise.calibration.judge import Judged
from slipwise.calibration.learned import Learned
from slipwise.calibration.learner import Posterior
from slipwise.calibration.settings import Settings
from slipwise.calibration.settings_for_log import RESIDUALS
from slipwise.calibration.shares import PoseSensor, shares_of
from slipwise.logs.log import Scale
from slipwise.models import schema
from slipwise.models.body_force import force_names
from slipwise.models.car import car_rows
from slipwise.models.limits import limit_rows, limits_section
from slipwise.models.parameter_table import ParameterTable, stage_of


@dataclass(frozen=True)
class ModelFacts:
    """Where a model comes from."""

    input_name: str  # "command" or "wheel"
    settings: Settings
    logs: list[schema.LogReference]
    range: schema.Range
    seconds: float  # of all segments learned
    segments: int
    positions: bool = False  # only positions were measured
    scale: Scale | None = None  # that its input was read with


def model_content(learned: Learned, judged: Judged, facts: ModelFacts) -> schema.ModelFile:
    """Return what a model file holds of what was learned and judged."""
    motion, verdict = learned.kept.motion, judged.verdict
    basis = motion.basis
    table, gains = _table(learned, facts.settings)
    return schema.ModelFile(
        slipwise_model=schema.SCHEMA_VERSION,
        input="command" if facts.input_name == "command" else "wheel",
        slip=schema.Slip(basis=basis.name, lon=basis.lon, lat=basis.lat, ang=basis.ang),
        dynamics=motion.dynamics,
        delays=motion.delays,
        lags=motion.lags,
        clock_offset=motion.clock_offset,
        response=motion.response,
        sensor_extrinsics=motion.sensor_extrinsics,
        wheelbase=motion.wheelbase or None,
        limit_gains=gains,
        **table.content(),
        noise=_noise(learned, facts.settings),
        slip_disturbance=_slip_disturbance(learned.kept, facts.settings.segment_length(facts.input_name)),
        body_force=_body_force(motion, facts.settings),
        range=_range(facts, learned),
        shares=_shares(learned, facts),
        weights=dict(zip(learned.bases, map(float, learned.kept.weights), strict=False)),
        provenance=schema.Provenance(
            slipwise_version=_version(),
            logs=facts.logs,
            settings=facts.settings.model_dump(exclude_defaults=True),
            learned_seconds=facts.seconds,
            learned_segments=facts.segments,
            residuals_per_segment=RESIDUALS if facts.positions else None,
            input_scale=None if facts.scale is None else list(facts.scale),
        ),
        verdict=schema.VerdictSection(
            good=verdict.good,
            sentence=verdict.sentence,
            not_identifiable=list(verdict.not_identifiable),
            advice=list(verdict.advice),
            confounded=[
                schema.Confounded(first=pair.first, second=pair.second, correlation=pair.correlation)
                for pair in verdict.confounded
            ],
            timing=verdict.timing,
            force=verdict.force,
            reservations=list(verdict.reservations),
            contradictions=list(verdict.contradictions),
            held_out=judged.judgement.held_out,
        ),
    )


def _table(learned: Learned, settings: Settings) -> tuple[ParameterTable, list[float] | None]:
    """All that was learned as one table, and the gains behind the drive's limits, where some are kept.

    Slip and actuator are learned together; limits and the curves of a car each apart from them.
    """
    kept, frame = learned.kept, settings.body_force.frame
    force = () if frame == "none" else force_names(frame)
    stds = np.sqrt(np.diag(kept.covariance))
    rows = tuple(
        schema.Parameter(
            name=info.name,
            stage=stage_of(info.name, force),
            unit=info.unit,
            value=float(kept.mean[i]),
            std=float(stds[i]),
            prior_std=float(kept.prior_std[i]),
            identifiable=bool(kept.variance_ratio[i] <= schema.UNIDENTIFIABLE_RATIO),
        )
        for i, info in enumerate(kept.motion.parameters)
    )
    table = ParameterTable(rows, kept.covariance)
    if learned.car is not None:
        table = table.beside(*car_rows(learned.car))
    if kept.limits is None or learned.limits is None:
        return table, None
    section = limits_section(learned.limits)
    found = limit_rows(section)
    table = table.beside(found, np.diag([row.std**2 for row in found]))
    return table, [section.gain_v, section.gain_omega]


def _range(facts: ModelFacts, learned: Learned) -> schema.Range:
    """What the robot did: a car's commands are throttle and steering, and its curves make speeds of them."""
    inputs, car, body = facts.range, learned.car, learned.body
    if car is None:
        curvature = None
        if learned.kept.motion.wheelbase and learned.evidence is not None:
            curvature = driven_curvature(learned.evidence.windows, facts.input_name)
        return inputs.model_copy(update={"body": body, "curvature": curvature})
    speed = [float(np.interp(end, car.speed.at, car.speed.value)) for end in inputs.speed]
    fastest = max(map(abs, speed))
    tightest = [
        fastest * float(np.interp(end, car.curvature.at, car.curvature.value)) for end in inputs.yaw_rate
    ]
    seen = body is not None and any(body.yaw_rate)
    return inputs.model_copy(
        update={
            "speed": speed,
            "yaw_rate": body.yaw_rate if body is not None and seen else tightest,
            "throttle": inputs.speed,
            "steering": inputs.yaw_rate,
            "body": body,
        }
    )


def _shares(learned: Learned, facts: ModelFacts) -> schema.Shares | None:
    """What arrives of commands that are speeds and yaw rates, where a learner kept the windows of the log."""
    if facts.input_name != "command" or learned.evidence is None or learned.car is not None:
        return None
    place = facts.settings.sensor_extrinsics
    sensor = PoseSensor(place.y, place.yaw, facts.positions)
    return shares_of(learned.evidence.windows, sensor)


def _noise(learned: Learned, settings: Settings) -> schema.Noise:
    shape = settings.noise
    return schema.Noise(
        psd_time=shape.psd_time,
        psd_motion=shape.psd_motion,
        fraction=shape.fraction,
        pose_std_xy=shape.pose_std_xy,
        pose_std_yaw=shape.pose_std_yaw,
        variance_scale=learned.kept.noise_scale.tolist(),
        student_t=learned.students,
    )


def _slip_disturbance(posterior: Posterior, segment: float) -> schema.SlipDisturbanceSection | None:
    if posterior.disturbance is None or not posterior.disturbance.law.candidates:  # it was not to be learned
        return None
    law = posterior.disturbance.law
    candidates = [
        schema.DisturbanceCandidate(
            linear=disturbance.linear,
            angular=disturbance.angular,
            time_constant=disturbance.time_constant,
            weight=float(weight),
        )
        for disturbance, weight in zip(law.candidates, law.weights, strict=True)
    ]
    return schema.SlipDisturbanceSection(segment=segment, candidates=candidates)


def _body_force(motion: _core.MotionModel, settings: Settings) -> schema.BodyForceSection | None:
    """The law of the force whose terms the model has."""
    table = settings.body_force
    if table.frame == "none" or not motion.slip_size:
        return None
    return schema.BodyForceSection(
        frame=table.frame,
        time_constant=table.time_constant,
        std=table.std,
    )


@cache
def _version() -> str:
    """Looked up once: the lookup reads files."""
    return version("slipwise")
