# SPDX-License-Identifier: Apache-2.0
"""Puts a node together from its settings: learner, cache, gates, what is handed on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from slipwise.calibration import Settings
from slipwise.calibration.coming import Coming
from slipwise.calibration.core_settings import car_of, wheelbase_of
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.settings_for_log import for_ground
from slipwise.errors import SettingsError
from slipwise.live.applied import AppliedModel
from slipwise.live.cache import Cache, CacheKey
from slipwise.live.gates import Gates, rules_for
from slipwise.live.handover import Handover
from slipwise.live.intake import Intake
from slipwise.live.learning import Learning
from slipwise.live.model_file import model_in, surfaces_before
from slipwise.live.move_adviser import MoveAdviser
from slipwise.live.node import LiveNode
from slipwise.live.node_parts import NodeParts
from slipwise.live.said import Said
from slipwise.live.samples import DriveStart
from slipwise.live.status import Identity
from slipwise.live.surface_watch import today
from slipwise.live.transport import Transport
from slipwise.live.watch.watcher import Watcher
from slipwise.logs.options import LogOptions
from slipwise.models import Model

_AS_IT_IS = LogOptions()


@dataclass(frozen=True)
class Built:
    """A node that is ready to run, and what it learns with."""

    node: LiveNode
    learning: Learning
    said: Said
    goes_on: bool = False  # from what was learned before


def build_node(  # noqa: PLR0913 (all that a node is made of)
    transport: Transport,
    input_name: str,
    settings: Settings,
    *,
    watchers: Sequence[Watcher] = (),
    run: str | None = None,
    command_timeout: float | None = None,
    read: LogOptions = _AS_IT_IS,
    kept: Learning | None = None,
    forget: bool = False,
) -> Built:
    """Return a node.

    Args:
        transport: brings samples and takes results.
        input_name: "command" or "wheel": the input that is learned from.
        settings: those of learning, and of [live].
        watchers: see all that the node gives.
        run: name of the run that begins; None: the transport says when one does.
        command_timeout: s after which the robot ends a command that is not repeated.
        read: how numbers are read: a cache of numbers that were read otherwise is not used.
        kept: what a node learned that has ended, and this one goes on with.
        forget: set aside what the cache has, and learn from nothing.

    Raises:
        SettingsError: settings contradict themselves.
        ModelError: the start model cannot be read.
        OutputError: a cache that cannot be read cannot be set aside either.
    """
    table, said = settings.live, Said()
    before = surfaces_before(table)
    if before is None:  # a memory that is continued keeps its terms
        settings = for_ground(settings, slopes=table.attitude, sideways=table.sideways)
    start = _start_model(table.model, input_name, drives_car=car_of(settings) is not None)
    cache, learner, valid = None, None, None
    if table.cache is not None:
        cache = Cache(Path(table.cache), CacheKey.of(table.name, input_name, settings, read))
        found = cache.forget() if forget else cache.load()
        learner, valid = found.learner, found.valid
        if found.said and kept is None:
            said.note(math.nan, found.said, error=learner is None)
    if kept is not None:  # it knows all that the cache does
        learner, valid = kept.learner, kept.valid
    goes_on = learner is not None
    if learner is None and table.memory and start is not None and before is None:
        said.note(math.nan, "the start model remembers no surfaces: the memory starts empty")
    learner = learner or _new_learner(input_name, settings, before, wheels=transport.wheels)
    learner.know_scale(read.command_scale if input_name == "command" else read.wheel_scale)
    learning = Learning(learner, start, valid, said)
    rules = rules_for(start)
    gates = Gates(rules, input_name=input_name)
    intake = Intake(learner, gates, said, input_name=input_name, command_timeout=command_timeout)
    of_wheels = transport.found if input_name == "wheel" else tuple
    learning.mounts = lambda last: intake.mounts(last=last)
    learning.of_stream = lambda: (*intake.contradictions(), *of_wheels())
    if run is not None:
        intake.start_drive(run, DriveStart(table.surface or "", today()))
    applying = table.apply.mode != "off"
    if table.apply.targets and not applying:
        said.note(
            math.nan,
            f"{', '.join(table.apply.targets)} get no parameters: live.apply.mode is off",
        )
    parts = NodeParts(
        who=Identity(table.name, input_name, table.apply.mode),
        transport=transport,
        learning=learning,
        intake=intake,
        gates=gates,
        said=said,
        adviser=MoveAdviser(reverse=rules.reverse, turning=intake.turning),
        watchers=watchers,
        applied=AppliedModel(table.apply.interval, start) if applying else None,
        handover=Handover(table.apply, said) if applying else None,
        cache=cache,
    )
    return Built(LiveNode(parts), learning, said, goes_on)


def _new_learner(input_name: str, settings: Settings, before: Model | None, *, wheels: bool) -> MotionLearner:
    """A learner that knows nothing, or a robot and its surfaces."""
    live = settings.live
    learner = MotionLearner(
        input_name,
        settings,
        coming=Coming(
            positions=live.positions, gyro_alone=live.gyro_alone, sources=tuple(live.sources)
        ),  # whose terms the settings hold already
        remember=live.memory,
        wheelbase=wheelbase_of(settings),
    )
    if before is not None:
        learner.begin_with(before, wheels=wheels, where=live.model or "")
    return learner


def _start_model(path: str | None, input_name: str, *, drives_car: bool) -> Model | None:
    if path is None:
        return None
    model = model_in(path)
    if input_name in model.inputs:
        model = model.of_input(input_name)
        if input_name == "command" and (model.car is not None) != drives_car:
            taken, sent = ("speeds and yaw rates", "throttle and steering")[:: 1 if drives_car else -1]
            raise SettingsError(
                f"the start model takes {taken}, this robot is sent {sent}",
                where=path,
                advice="give a model of this robot, and --vehicle where it is a car with a throttle",
            )
        return model
    if model.content.input != input_name:
        raise SettingsError(
            f"the start model was learned from {model.content.input}s, this node learns from {input_name}s",
            where=path,
            advice=f"use --input {model.content.input}",
        )
    return model
