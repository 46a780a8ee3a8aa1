# SPDX-License-Identifier: Apache-2.0
"""The surfaces that a learner remembers, as the model file has them, and back."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.calibration.learner import BASELINE, CASCADED, DIRECT, JOINT, LIMITS, STRUCTURES
from slipwise.errors import ModelError, SettingsError
from slipwise.models.model import Model
from slipwise.models.schema import (
    LabelSection,
    MeasuredBody,
    ModelFile,
    Range,
    SurfaceBasis,
    SurfaceMemorySection,
    SurfaceSection,
)


def surface_sections(
    learner: _core.MotionLearner, structure: int, motion: _core.MotionModel
) -> tuple[SurfaceSection, ...]:
    """Return the surfaces with the slip of a model; the baseline has none.

    Args:
        learner: what remembers them.
        structure: how the model explains motion.
        motion: the model, whose first parameters are the slip.
    """
    if structure == BASELINE:
        return ()
    sections = []
    for surface in learner.surfaces().surfaces:
        known = learner.on_surface(surface, structure)
        if known is None:
            continue
        speed, yaw_rate = surface.speeds
        size = motion.basis.size
        sections.append(
            SurfaceSection(
                name=surface.name,
                seconds=surface.seconds,
                segments=surface.segments,
                visits=surface.visits,
                last_seen=surface.last_seen,
                speed=speed,
                yaw_rate=yaw_rate,
                slip=known.state.estimate.mean[:size].tolist(),
                covariance=known.state.estimate.covariance[:size, :size].tolist(),
                memory=_memory(known),
                classes=dict(surface.classes),
            )
        )
    return tuple(sections)


def _memory(known: _core.SlipOnSurface) -> SurfaceMemorySection:
    memory = known.memory
    return SurfaceMemorySection(
        observed=memory.observed,
        prior_speeds=list(known.prior_speeds),
        weights=dict(zip(memory.bases, map(float, memory.weights), strict=True)),
        bases={
            name: SurfaceBasis(
                slip=slip.mean.tolist(),
                covariance=slip.covariance.tolist(),
                by_robot=slip.by_robot.tolist(),
                robot=slip.robot.tolist(),
                variance_scale=slip.noise_scale.tolist(),
            )
            for name, slip in zip(memory.bases, memory.slips, strict=True)
        },
    )


def label_section(learner: _core.MotionLearner) -> LabelSection | None:
    """Return what labels were worth; None where there were none."""
    judged, right = learner.surfaces().labels
    return LabelSection(all=judged, right=right) if judged else None


def with_memory(
    content: ModelFile,
    learner: _core.MotionLearner,
    kept: tuple[int, _core.MotionModel],
    start: Model | None,
) -> ModelFile:
    """Add surfaces and labels to a model's content, and what the model that was begun with was learned from.

    Args:
        content: of what was learned now.
        learner: what remembers surfaces.
        kept: how the model explains motion, and the model.
        start: the model that was begun with.
    """
    memory: dict[str, object] = {
        "surfaces": list(surface_sections(learner, *kept)),
        "labels": label_section(learner),
    }
    if start is None:
        return content.model_copy(update=memory)
    before, now = start.content.provenance, content.provenance
    memory["provenance"] = now.model_copy(
        update={
            "logs": [*before.logs, *(log for log in now.logs if log not in before.logs)],
            "learned_seconds": before.learned_seconds + now.learned_seconds,
            "learned_segments": before.learned_segments + now.learned_segments,
        }
    )
    memory["range"] = _wider(start.content.range, content.range)
    return content.model_copy(update=memory)


def _wider(a: Range, b: Range) -> Range:
    spans = {}
    for name in ("speed", "yaw_rate", "throttle", "steering"):
        one, other = getattr(a, name), getattr(b, name)
        spans[name] = one and other and _wider_span(one, other)
    return Range(
        **spans,
        sideways=_wider_span(a.sideways, b.sideways),
        curvature=max((each for each in (a.curvature, b.curvature) if each is not None), default=None),
        slope=max(a.slope, b.slope),
        wheel_step=max(a.wheel_step, b.wheel_step),
        body=a.body and b.body and _wider_body(a.body, b.body),
    )


def _wider_span(a: list[float] | None, b: list[float] | None) -> list[float] | None:
    if a is None or b is None:
        return a or b
    return [min(a[0], b[0]), max(a[1], b[1])]


def _wider_body(a: MeasuredBody, b: MeasuredBody) -> MeasuredBody:
    def farther(one: list[float], other: list[float]) -> list[float]:
        return [max(pair, key=abs) for pair in zip(one, other, strict=True)]

    return MeasuredBody(
        speed=farther(a.speed, b.speed),
        yaw_rate=farther(a.yaw_rate, b.yaw_rate),
        acceleration=farther(a.acceleration, b.acceleration),
        yaw_acceleration=farther(a.yaw_acceleration, b.yaw_acceleration),
        held=farther(a.held, b.held),
        seconds=a.seconds + b.seconds,
    )


def known_before(model: Model) -> _core.KnownBefore:
    """Return a model and its surfaces as a learner begins with them.

    Raises:
        ModelError: the model remembers no surface, or only serves predictions on them.
    """
    content = model.content
    if not content.surfaces:
        raise ModelError(
            "the model remembers no surfaces",
            advice="learn it with `slipwise calibrate --memory LOG...`",
        )
    surfaces = []
    for surface in content.surfaces:
        if surface.memory is None:
            raise ModelError(
                f"learning cannot go on from the surface {surface.name!r}: the file has no memory of it",
                advice="learn the logs again with `slipwise calibrate --memory LOG...`",
            )
        surfaces.append(_known_surface(surface, surface.memory))
    labels = content.labels or LabelSection(all=0.0, right=0.0)
    return _core.KnownBefore(model.posterior, structure_of(model), surfaces, (labels.all, labels.right))


def begin_with(
    learner: _core.MotionLearner, model: Model, input_name: str, *, wheels: bool, where: str = ""
) -> None:
    """Let a learner begin with the robot and the surfaces of a model file, before anything is pushed.

    Args:
        learner: which has learned nothing yet.
        model: of the same input, learned with a memory of surfaces.
        input_name: of the learner, "command" or "wheel".
        wheels: whether wheel speeds will come beside commands.
        where: the model's file, for errors.

    Raises:
        ModelError: the model has another input, or no memory of surfaces.
        SettingsError: something was learned already, or the model was learned with other bases or
            structures.
    """
    if model.content.input != input_name:
        raise ModelError(
            f"the model to begin with is of {model.content.input}s, and these logs are of {input_name}s",
            advice=f"say --input {model.content.input}, where the logs have them",
        )
    if (model.content.wheelbase or 0.0) != learner.settings.hypotheses.wheelbase:
        raise ModelError(
            "lags of the model to begin with act on another thing than here: its wheelbase is another",
            advice="give the wheelbase that it was learned with, or learn the memory again",
        )
    known = known_before(model)
    ours = {basis.name for basis in learner.settings.hypotheses.bases}
    theirs = model.content.surfaces[0].memory
    if theirs is not None and ours.isdisjoint(theirs.bases):
        raise SettingsError(
            f"the surfaces were learned with {', '.join(theirs.bases)}, not with {', '.join(sorted(ours))}",
            where="basis",
            advice="give the settings that they were learned with",
        )
    try:
        learner.begin_with(known, model.disturbance, wheels)
    except ValueError as problem:
        untried = _untried(learner.settings.hypotheses, model, where)
        raise untried or SettingsError(str(problem), where=where) from problem


def _untried(ours: _core.HypothesisSettings, model: Model, where: str) -> SettingsError | None:
    """Return what to say of surfaces of a structure that is not tried here; None where it is."""
    structure = structure_of(model)
    if model.content.response:
        structure, tried = CASCADED, ours.cascaded
    else:
        tried = structure != DIRECT or ours.direct
    if tried:
        return None
    basis = model.content.provenance.settings.get("basis", "auto")
    return SettingsError(
        f"the surfaces were learned by the structure {STRUCTURES[structure]!r}, which is not tried with the "
        f"basis {', '.join(each.name for each in ours.bases)}",
        where=where,
        advice=f"leave --basis away, or give the settings that they were learned with (basis {basis!r})",
    )


def structure_of(model: Model) -> int:
    """Return how a model explains motion, of `learner.STRUCTURES`."""
    content = model.content
    if content.limit_gains is not None:
        return LIMITS
    if content.response:
        return CASCADED
    return DIRECT if content.delays else JOINT


def _known_surface(surface: SurfaceSection, memory: SurfaceMemorySection) -> _core.KnownSurface:
    v, omega = memory.prior_speeds
    slips = []
    for basis in memory.bases.values():
        size = len(basis.slip)
        slips.append(
            _core.SurfaceSlip(
                np.array(basis.slip, dtype=np.float64),
                np.array(basis.covariance, dtype=np.float64).reshape(size, size),
                np.array(basis.by_robot, dtype=np.float64).reshape(size, len(basis.robot)),
                np.array(basis.robot, dtype=np.float64),
                (v, omega),
                np.array(basis.variance_scale, dtype=np.float64),
            )
        )
    names = list(memory.bases)
    weights = np.array([memory.weights[name] for name in names])
    return _core.KnownSurface(
        surface.name,
        (surface.seconds, surface.speed, surface.yaw_rate),
        (surface.segments, surface.visits),
        surface.last_seen,
        _core.SurfaceMemory(names, slips, weights, memory.observed),
        list(surface.classes.items()),
    )
