# SPDX-License-Identifier: Apache-2.0
"""The logs of `slipwise calibrate`, opened and learned: all together, or in turn with surfaces remembered."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.calibration import Calibration, Settings
    from slipwise.calibration.learned_sequence import LearnedSequence, SequenceOptions
    from slipwise.logs import Log, LogOptions


@dataclass(frozen=True)
class Asked:
    """What is to be learned, and how."""

    paths: Sequence[Path]  # logs, and a model to go on from
    log_options: LogOptions
    input: str | None
    settings: Settings | None  # None: those of the model to go on from, or the defaults
    memory: bool  # of surfaces
    labels: Sequence[str]
    prior: Path | None = None  # what a fleet knows

    @property
    def smooth(self) -> bool:
        """Whether the settings ask for smoothing over the whole log."""
        return self.settings is not None and self.settings.smoothing.smooth


@dataclass(frozen=True, eq=False)
class Opened:
    """The logs that were asked for."""

    asked: Asked
    logs: tuple[Log, ...]
    names: tuple[str, ...]  # of their files
    log: Log  # all of them together
    begin: SequenceOptions | None  # what a memory begins with; None without one


@dataclass(frozen=True, eq=False)
class LearnedLogs:
    """What was learned."""

    calibration: Calibration
    settings: Settings
    sequence: LearnedSequence | None  # where surfaces were remembered


def opened(asked: Asked) -> Opened:
    """Read the logs.

    Raises:
        LogError: a log cannot be read.
        SettingsError: options contradict each other.
        ModelError: the model to go on from cannot be read.
    """
    from slipwise.cli.memory_options import refuse_labels, sequence_options, split_model
    from slipwise.errors import SettingsError
    from slipwise.logs import open_log
    from slipwise.logs.open_log import joined

    if asked.prior is not None and (asked.memory or asked.smooth):
        raise SettingsError(
            "a fleet's prior is of one log on one surface",
            where="--prior",
            advice=f"leave {'--memory' if asked.memory else 'smoothing.smooth'} or --prior away",
        )
    if not asked.memory:
        refuse_labels(asked.labels)
        return Opened(asked, (), (), open_log(*asked.paths, options=asked.log_options), None)
    if asked.smooth:
        raise SettingsError(
            "smoothing is over one surface",
            where="smoothing.smooth",
            advice="leave one away",
        )
    models, paths = split_model(asked.paths)
    begin = sequence_options(models, asked.labels, paths)
    logs = tuple(open_log(path, options=asked.log_options) for path in paths)
    return Opened(asked, logs, tuple(path.name for path in paths), joined(list(logs)), begin)


def learn_logs(given: Opened, progress: Callable[[float], None]) -> LearnedLogs:
    """Learn the logs.

    Raises:
        LogError: there is nothing to learn from, or no model holds it.
        SettingsError: a basis is unknown, or the estimator has no memory of surfaces.
        ModelError: learning cannot go on from the model.
    """
    from slipwise.calibration import Settings
    from slipwise.calibration.both_inputs import calibrate_inputs
    from slipwise.calibration.calibrate_sequence import calibrate_sequence, settings_of

    asked = given.asked
    if given.begin is None:
        settings = asked.settings or Settings()
        if asked.prior is not None:
            from slipwise.calibration.from_prior import KnownFleet, calibrate_from

            known = KnownFleet.load(asked.prior)
            calibration, _ = calibrate_from(
                given.log, known, input=asked.input, settings=settings, progress=progress
            )
            calibration = _with_one_input(calibration, given.log, asked.input, "a prior is of one input")
            return LearnedLogs(calibration, settings, None)
        calibration = calibrate_inputs(
            given.log, input=asked.input, settings=settings, smooth=asked.smooth, progress=progress
        )
        return LearnedLogs(calibration, settings, None)
    start = given.begin.start
    settings = asked.settings or (Settings() if start is None else settings_of(start))
    calibration, sequence = calibrate_sequence(
        given.logs, input=asked.input, settings=settings, options=given.begin, progress=progress
    )
    calibration = _with_one_input(calibration, given.log, asked.input, "surfaces are of one input")
    return LearnedLogs(calibration, settings, sequence)


def _with_one_input(calibration: Calibration, log: Log, asked: str | None, why: str) -> Calibration:
    """Say why a model of commands is all that is learned of a log that has wheel speeds too."""
    from slipwise.calibration.both_inputs import one_input_alone, with_note
    from slipwise.calibration.prepared_run import input_names

    if asked is not None or len(input_names(log)) < 2 or calibration.model.content.input != "command":
        return calibration
    return with_note(calibration, one_input_alone(why))
