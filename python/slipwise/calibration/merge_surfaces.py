# SPDX-License-Identifier: Apache-2.0
"""The surfaces of two model files of one robot in one: surfaces that cannot be distinguished become one."""

from __future__ import annotations

from dataclasses import dataclass

from slipwise import _core
from slipwise.calibration.calibrate import JUDGING_HORIZONS
from slipwise.calibration.calibrate_sequence import settings_of
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.learner import CASCADED
from slipwise.calibration.same_log import logs_of_both, twice_in_both
from slipwise.calibration.surface_sections import begin_with, known_before, structure_of, surface_sections
from slipwise.errors import ModelError
from slipwise.models.model import Model
from slipwise.models.schema import LabelSection, SurfaceSection, VerdictSection

_VEHICLE = ("vehicle", "sensor_extrinsics")  # sections of the settings that are the robot's
# Of the model.
_FORM = ("dynamics", "delays", "lags", "clock_offset", "response", "sensor_extrinsics", "wheelbase")


@dataclass(frozen=True)
class MergedSurface:
    """Where a surface of the second file went."""

    name: str  # in the second file
    became: str  # in the result; empty where it was dropped as the least used of too many
    merged: bool  # with one that the first file has


def merge_surfaces(first: Model, second: Model) -> tuple[Model, tuple[MergedSurface, ...]]:
    """Return the first model with the surfaces of both, and what became of those of the second.

    Surfaces whose predictive densities cannot be distinguished are multiplied, the prior that both began from
    counting once (derivations/surfaces.md). The robot, and the surface that is driven on, are those of
    the first model.

    Raises:
        ModelError: the models differ in input, slip terms, structure or vehicle, or have no memory.
        SettingsError: the settings in the first file are wrong.
    """
    _refuse_others(first, second)
    settings, structure = settings_of(first), structure_of(first)
    wheelbase = first.content.wheelbase
    core = core_settings(settings, first.content.input, JUDGING_HORIZONS, remember=True, wheelbase=wheelbase)
    learner = _core.MotionLearner(core)
    begin_with(learner, first, first.content.input, wheels=first.content.response or structure == CASCADED)
    try:
        names = learner.add_surfaces(known_before(second))
    except ValueError as problem:
        raise ModelError(str(problem)) from problem
    events = learner.surface_events()
    made = {each.name: each for each in surface_sections(learner, structure, first.motion)}
    untouched = {each.name: each for each in first.content.surfaces}
    untouched |= {
        name: each.model_copy(update={"name": name})
        for name, each in zip(names, second.content.surfaces, strict=True)
    }
    joined = {event.name for event in events if event.kind == _core.SurfaceEventKind.Merged}
    sections = [each if name in joined else untouched[name] for name, each in made.items()]
    moved = {event.other: event.name for event in events if event.kind == _core.SurfaceEventKind.Merged}
    done = tuple(
        _became(each.name, name, moved, made)
        for name, each in zip(names, second.content.surfaces, strict=True)
    )
    return _with_surfaces(first, second, sections), done


def _became(name: str, wanted: str, moved: dict[str, str], made: dict[str, SurfaceSection]) -> MergedSurface:
    became = wanted
    while became in moved:
        became = moved[became]
    return MergedSurface(name, became if became in made else "", became != wanted)


def _with_surfaces(first: Model, second: Model, sections: list[SurfaceSection]) -> Model:
    one, two = first.content.provenance, second.content.provenance
    labels = [each.content.labels for each in (first, second) if each.content.labels is not None]
    return Model(
        first.content.model_copy(
            update={
                "surfaces": sections,
                "labels": LabelSection(
                    all=sum(each.all for each in labels), right=sum(each.right for each in labels)
                )
                if labels
                else None,
                "verdict": _reserved(first, second),
                "provenance": one.model_copy(
                    update={"logs": [*one.logs, *(log for log in two.logs if log not in one.logs)]}
                ),
            }
        )
    )


def _reserved(first: Model, second: Model) -> VerdictSection:
    """Return the verdict on the first model, qualified where what both have learned counts twice."""
    verdict, both = first.content.verdict, logs_of_both(first, second)
    if not (both and verdict.good):
        return verdict
    sentence = twice_in_both(both)
    return verdict.model_copy(
        update={
            "sentence": f"{verdict.sentence} {sentence}",
            "reservations": [*verdict.reservations, sentence],
        }
    )


def _refuse_others(first: Model, second: Model) -> None:
    one, two = first.content, second.content
    if one.input != two.input:
        raise ModelError(f"one model is of {one.input}s and the other of {two.input}s", advice=_SAME)
    if one.slip != two.slip:
        raise ModelError(
            f"the models have other slip terms ({one.slip.basis}, {two.slip.basis})", advice=_SAME
        )
    for name in _FORM:
        if getattr(one, name) != getattr(two, name):
            raise ModelError(f"one model has {name.replace('_', ' ')} and the other has not", advice=_SAME)
    for name in _VEHICLE:
        if one.provenance.settings.get(name) != two.provenance.settings.get(name):
            raise ModelError(f"the models were learned with other settings of [{name}]", advice=_SAME)


_SAME = "surfaces are joined of one robot, learned from the same input with the same basis"
