# SPDX-License-Identifier: Apache-2.0
"""Why a log has too few segments to judge a model by, and what would give more."""

from __future__ import annotations

from slipwise.calibration.judgement import FEWEST_WINDOWS
from slipwise.calibration.prepared_run import WindowSet, collect_windows, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.errors import LogError
from slipwise.logs.findings.command_stops import stops_of
from slipwise.logs.log import Log
from slipwise.models.inputs import INPUT_NAMES

NEEDED = 2 * FEWEST_WINDOWS  # segments, half of which are held out
_NAMES = {"command": "commands", "wheel": "wheel speeds"}
_CURES = {
    "late-pose": "record poses at a steady rate",
    "unknown-input": "record the inputs without gaps, or raise unknown_after under [segment]",
    "standing-still": "drive for more of the time",
    "heading-ambiguous": "record poses more often, or turn more slowly",
}


def shortage_advice(log: Log, input_name: str, shortest: WindowSet, settings: Settings) -> tuple[str, ...]:
    """Say what to do about too few segments.

    Args:
        log: the data to learn from.
        input_name: the input that is learned from.
        shortest: the segments of the shortest horizon that is judged.
        settings: those of learning.
    """
    silent = silence(shortest)
    advice = [] if silent is None else [f"{silent[0][0].upper()}{silent[0][1:]}.", silent[1]]
    advice += [
        f"Rejected: {item.count} x {item.reason}; {_CURES[item.kind]}."
        for item in sorted(shortest.left_out, key=lambda item: -item.count)
        if item.count >= FEWEST_WINDOWS and item.kind in _CURES
    ]
    for other in INPUT_NAMES:
        count = 0 if other == input_name else _segments(log, other, shortest.length, settings)
        if count >= NEEDED:
            advice.append(f"From {_NAMES[other]} the log has {count} segments: use --input {other}.")
    advice.append(
        f"Record a drive of some minutes with poses and {_NAMES[input_name]} all along: at the very least "
        f"{NEEDED} segments of {shortest.length:g} s, where this log has {len(shortest)}."
    )
    return tuple(advice)


def silence(windows: WindowSet) -> tuple[str, str] | None:
    """Say how rarely commands come, where they do, and what to do about it."""
    if windows.drive[0].input_name != "command":
        return None
    pairs = [(run.inputs, run.run.poses) for run in windows.drive]
    return stops_of(pairs).words(windows.unknown_after)


def _segments(log: Log, input_name: str, length: float, settings: Settings) -> int:
    try:
        return len(collect_windows(prepare_run(log, input_name), length, settings.rules()))
    except LogError:
        return 0
