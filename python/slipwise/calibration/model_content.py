# SPDX-License-Identifier: Apache-2.0
"""What was learned and judged, as the model file has it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.metadata import version

import numpy as np

from slipwise import _core
from slipwise.calibration.judge import Judged
from slipwise.calibration.learned import Learned
from slipwise.calibration.learner import Posterior
from slipwise.calibration.settings import Settings
from slipwise.models import schema
from slipwise.models.car import car_section
from slipwise.models.limits import limits_section


@dataclass(frozen=True)
class ModelFacts:
    """Where a model comes from."""

    input_name: str  # "command" or "wheel"
    settings: Settings
    logs: list[schema.LogReference]
    range: schema.Range
    seconds: float  # of all segments learned
    segments: int


def model_content(learned: Learned, judged: Judged, facts: ModelFacts) -> schema.ModelFile:
    """Return what a model file holds of what was learned and judged."""
    motion, verdict = learned.kept.motion, judged.verdict
    basis = motion.basis
    return schema.ModelFile(
        slipwise_model=schema.SCHEMA_VERSION,
        input="command" if facts.input_name == "command" else "wheel",
        slip=schema.Slip(basis=basis.name, lon=basis.lon, lat=basis.lat, ang=basis.ang),
        dynamics=motion.dynamics,
        delays=motion.delays,
        clock_offset=motion.clock_offset,
        response=motion.response,
        sensor_extrinsics=motion.sensor_extrinsics,
        car=None if learned.car is None else car_section(learned.car),
        limits=_limits(learned),
        parameters=_parameters(learned.kept),
        covariance=learned.kept.covariance.tolist(),
        noise=_noise(learned, facts.settings),
        slip_disturbance=_slip_disturbance(learned.kept, facts.settings.segment_length(facts.input_name)),
        body_force=_body_force(motion, facts.settings),
        range=facts.range.model_copy(update={"body": learned.body}),
        weights=dict(zip(learned.bases, map(float, learned.kept.weights), strict=False)),
        provenance=schema.Provenance(
            slipwise_version=_version(),
            logs=facts.logs,
            settings=facts.settings.model_dump(exclude_defaults=True),
            learned_seconds=facts.seconds,
            learned_segments=facts.segments,
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


def _limits(learned: Learned) -> schema.LimitsSection | None:
    """Limits that a search found, where they are kept."""
    return None if learned.kept.limits is None or learned.limits is None else limits_section(learned.limits)


def _parameters(posterior: Posterior) -> list[schema.Parameter]:
    stds = np.sqrt(np.diag(posterior.covariance))
    return [
        schema.Parameter(
            name=info.name,
            unit=info.unit,
            value=float(posterior.mean[i]),
            std=float(stds[i]),
            prior_std=float(posterior.prior_std[i]),
            identifiable=bool(posterior.variance_ratio[i] <= schema.UNIDENTIFIABLE_RATIO),
        )
        for i, info in enumerate(posterior.motion.parameters)
    ]


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
