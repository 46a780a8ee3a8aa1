# SPDX-License-Identifier: Apache-2.0
"""From a sequence of logs to a model that remembers the surfaces they were driven on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from slipwise.calibration.calibrate import (
    JUDGING_HORIZONS,
    found_contradictions,
    judged_content,
    learned_mounts,
    learning_windows,
    model_of,
    notes_of,
    refuse_empty,
)
from slipwise.calibration.learned_log import Keep
from slipwise.calibration.learned_sequence import LearnedSequence, SequenceOptions, learn_sequence
from slipwise.calibration.learner import Progress
from slipwise.calibration.prepared_run import PreparedRun, choose_input, prepare_run, unused_runs
from slipwise.calibration.result import Calibration
from slipwise.calibration.same_log import refuse_same_log
from slipwise.calibration.settings import AVERAGE, Settings, make_settings
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.calibration.surface_labels import named_seconds, overruled
from slipwise.calibration.surface_sections import with_memory
from slipwise.errors import LogError, SettingsError
from slipwise.logs.findings.finding import Finding
from slipwise.logs.log import Log
from slipwise.logs.open_log import joined
from slipwise.models.model import Model

_NOTHING = SequenceOptions()


def calibrate_sequence(
    logs: Sequence[Log],
    *,
    input: str | None = None,
    settings: Settings | None = None,
    options: SequenceOptions = _NOTHING,
    progress: Progress | None = None,
) -> tuple[Calibration, LearnedSequence]:
    """Learn the motion model of a robot from logs one after the other, remembering surfaces.

    Its parameters are those of the surface that the last log ended on. The verdict is on the predictions of
    all logs.

    Args:
        logs: what `open_log` returned of each, in the order of time.
        input: "command" or "wheel"; without it that of the model to begin with, or what the first log has.
        settings: what to learn and how; without them those of the model to begin with, or the defaults. The
            first log decides whether terms of gravity are tried: no prediction depends on what comes later.
        options: the model to begin with, and labels.
        progress: called with the fraction done, 0 to 1.

    Raises:
        LogError: a log has no such input or no poses, all have no window to learn from, two are the same
            drive, or no model holds it.
        SettingsError: a basis is unknown, or the estimator has no memory.
        ModelError: the model to begin with has another input, or no memory of surfaces.
    """
    if not logs:
        raise LogError("a sequence needs a log", where="--memory", advice="give logs in the order of time")
    start = options.start
    settings = settings or (Settings() if start is None else settings_of(start))
    if settings.estimator != AVERAGE:
        raise SettingsError(
            f"only the estimator {AVERAGE!r} has a memory of surfaces",
            where="--memory",
            advice="leave out estimator or --memory",
        )
    if start is None:  # what is begun with keeps its terms: nothing is remembered of others
        settings = for_the_ground_of(logs[0], settings)
    input_name = choose_input(logs[0], input or (None if start is None else start.content.input))
    log = joined(list(logs))
    refuse_same_log(log)
    drives = _drives(logs, input_name)
    windows = learning_windows(tuple(run for drive in drives for run in drive), input_name, settings)
    refuse_empty(windows, log)
    keep = Keep(settings.wheel_separation)
    sequence = learn_sequence(
        drives, settings, JUDGING_HORIZONS, options=replace(options, keep=keep), progress=progress
    )
    learned = sequence.learned
    assert learned is not None  # it was asked to be kept
    found = found_contradictions(learned, windows.drive, (log, input_name, settings), start)
    found += _overruled(drives, sequence, options)
    judged, content = judged_content(learned, windows, (log, input_name, settings), found)
    kept = learned.kept.structure, learned.kept.motion
    mounts = learned_mounts(learned, log, settings)
    model = model_of(with_memory(content, sequence.learner, kept, start), log, found, mounts)
    calibration = Calibration(
        model,
        judged.verdict,
        learned.history,
        (*log.left_out, *unused_runs(log, input_name), *windows.left_out),
        notes_of(learned, log, found, mounts),
        None,
        learned.predictions,
        mounts=mounts,
    )
    return calibration, sequence


def _overruled(
    drives: Sequence[Sequence[PreparedRun]], sequence: LearnedSequence, options: SequenceOptions
) -> tuple[Finding, ...]:
    """Return which labels of the logs, or given for them, no surface is called by."""
    if options.terrain is not None:  # windows are probabilities, not names
        return ()
    named: dict[str, float] = {}  # s
    for drive, label in zip(drives, options.labels or ("",) * len(drives), strict=True):
        for name, seconds in named_seconds(drive, label).items():
            named[name] = named.get(name, 0.0) + seconds
    return overruled(named, {surface.name for surface in sequence.surfaces})


def settings_of(model: Model) -> Settings:
    """Return the settings that a model was learned with."""
    return make_settings(model.content.provenance.settings, where="settings in the model file", saved=True)


def _drives(logs: Sequence[Log], input_name: str) -> list[tuple[PreparedRun, ...]]:
    """Prepare each log; runs are counted over all of them."""
    drives, before = [], 0
    for log in logs:
        drives.append(tuple(replace(run, index=run.index + before) for run in prepare_run(log, input_name)))
        before += len(log.runs)
    return drives
