# SPDX-License-Identifier: Apache-2.0
"""One model of a log that has commands and wheel speeds: both are learned, and it answers from either."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from threading import Event

from slipwise.calibration.calibrate import calibrate
from slipwise.calibration.learner import Progress
from slipwise.calibration.prepared_run import input_names
from slipwise.calibration.result import Calibration
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.errors import LogError
from slipwise.logs.findings.command_answers import EchoedCommands
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.log import Log
from slipwise.models.inputs import INPUT_NAMES
from slipwise.models.model import Model


class _Stopped(Exception):  # noqa: N818 - no error
    """Nobody waits any more for what is learned beside."""


def calibrate_inputs(
    log: Log,
    *,
    input: str | None = None,
    settings: Settings | None = None,
    smooth: bool = False,
    progress: Progress | None = None,
) -> Calibration:
    """Learn from the input that is asked for; where none is, from both if the log has both.

    The model is of commands then, and holds what was learned from wheel speeds beside it
    (`Model.of_input`): each is what `calibrate` learns from this input alone. They are learned at the same
    time, on two cores.

    Args:
        log: what `open_log` returned.
        input: "command" or "wheel"; by default both.
        settings: what to learn and how.
        smooth: also say what the slip was during each window; from one input alone.
        progress: called with the fraction done, 0 to 1.

    Raises:
        LogError: the log has no such input, no poses or no window to learn from, or no model holds it.
        SettingsError: a basis, a term or the input is unknown.
    """
    settings = settings or Settings()
    if input is not None or len(input_names(log)) < len(INPUT_NAMES):
        return calibrate(log, input=input, settings=settings, smooth=smooth, progress=progress)
    why = _commands_alone(log, settings, smooth=smooth)
    if why:
        commands = calibrate(log, input="command", settings=settings, smooth=smooth, progress=progress)
        return with_note(commands, why)
    return _learned_together(log, settings, progress)


def with_note(calibration: Calibration, note: str) -> Calibration:
    """Return the calibration with a further note."""
    return replace(calibration, notes=(*calibration.notes, note))


def _commands_alone(log: Log, settings: Settings, *, smooth: bool) -> str:
    """Say why nothing is learned from the wheel speeds of a log that has commands too; empty if it is."""
    if smooth or settings.estimator != AVERAGE:
        who = "smoothing" if smooth else f"the estimator {settings.estimator}"
        return one_input_alone(f"{who} takes one input")
    if EchoedCommands().look_at(WholeLog(log, "command", settings.segment.unknown_after)) is not None:
        return "No model of its own is learned from wheel speeds: they echo the commands."
    return ""


def one_input_alone(why: str) -> str:
    """Say that wheel speeds have no model of their own, since what was asked for takes one input."""
    return f"No model of its own is learned from wheel speeds: {why} (--input wheel takes them)."


def _learned_together(log: Log, settings: Settings, progress: Progress | None) -> Calibration:
    stop, done = Event(), [0.0]

    def from_wheels(fraction: float) -> None:
        done[0] = fraction
        if stop.is_set():
            raise _Stopped

    def from_commands(fraction: float) -> None:
        if progress is not None:
            progress(0.5 * (fraction + done[0]))

    with ThreadPoolExecutor(1) as beside:
        waiting = beside.submit(calibrate, log, input="wheel", settings=settings, progress=from_wheels)
        try:
            commands = calibrate(log, input="command", settings=settings, progress=from_commands)
            try:
                wheels = waiting.result()
            except LogError as problem:
                why = f"No model of its own is learned from wheel speeds: {problem.what}."
                return with_note(commands, why)
        finally:
            stop.set()
    model = Model(commands.model.content.model_copy(update={"other_input": wheels.model.content}))
    lacking = [f"{item.count} x {item.reason}" for item in wheels.left_out if item.kind == "unused-run"]
    said = [f"From wheel speeds: {note}" for note in (*wheels.notes, *lacking) if note not in commands.notes]
    return replace(commands, model=model, other=wheels, notes=(*commands.notes, *said))
