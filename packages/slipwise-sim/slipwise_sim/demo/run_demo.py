# SPDX-License-Identifier: Apache-2.0
"""Simulates a drive and treats its bag as any user's: read, calibrate, evaluate, report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from slipwise.calibration import Calibration, Settings, calibrate
from slipwise.errors import SettingsError
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.logs import Log, open_log, save_log
from slipwise_sim import Scenario, simulate

INPUT = "command"  # what a planner knows: where the robot was commanded to go, not how its wheels turned
METHODS = ("none", "vendor", "edd-2", "auto")
VENDOR_WHEEL_SEPARATION_MULTIPLIER = (
    1.875  # Clearpath's for the Husky, a number such as a vendor would have typed in
)
HORIZONS = (1.0, 2.0, 5.0)  # [s]
SHORTEST = 60.0  # [s] a shorter drive has too few held-out windows to judge by

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class DemoOptions:
    """What is demonstrated."""

    duration: float = 300.0  # [s]
    seed: int = 1
    command: str = "slipwise demo"  # shown in the report


@dataclass(frozen=True, eq=False)
class DemoResult:
    """What the demonstration gave, and what it wrote."""

    log: Log
    calibration: Calibration
    evaluation: Evaluation
    bag: Path
    model: Path
    report: Path


def run_demo(
    folder: Path, options: DemoOptions, *, progress: Progress = lambda _what, _share: None
) -> DemoResult:
    """Write drive.mcap, model.yaml and report.html into `folder`.

    Args:
        folder: where to write; created if it is not there.
        options: length and seed of the drive.
        progress: called with the current step and the fraction of the whole that is done, 0 to 1.

    Raises:
        SlipwiseError: MuJoCo is missing, the drive is too short to learn from, or a file cannot be written.
    """
    if not options.duration >= SHORTEST:
        what = f"the demonstration lasts {options.duration:g} s"
        raise SettingsError(what, where="--duration", advice=f"give at least {SHORTEST:g} s to learn from")
    progress("simulating", 0.0)
    scenario = Scenario(duration=options.duration)
    simulation = simulate(
        scenario, seed=options.seed, progress=lambda fraction: progress("simulating", 0.6 * fraction)
    )
    progress("writing the bag", 0.6)
    bag = folder / "drive.mcap"
    save_log(simulation.log, bag)
    progress("reading the bag", 0.7)
    log = open_log(bag)
    progress("learning", 0.75)
    calibration = calibrate(log, input=INPUT)
    model = calibration.model.save(folder / "model.yaml")
    evaluation = evaluate(
        log,
        input=INPUT,
        settings=Settings(),
        options=EvaluationOptions(
            HORIZONS,
            METHODS,
            VENDOR_WHEEL_SEPARATION_MULTIPLIER,
            made={calibration.method: calibration.predictions},
        ),
        progress=lambda name, fraction: progress(f"judging {name}", 0.8 + 0.1 * fraction),
    )
    progress("writing the report", 0.9)
    report = _report(folder / "report.html", (log, calibration, evaluation), options)
    progress("done", 1.0)
    return DemoResult(log, calibration, evaluation, bag, model, report)


def _report(path: Path, result: tuple[Log, Calibration, Evaluation], options: DemoOptions) -> Path:
    from slipwise.reporting import write_report

    log, calibration, evaluation = result
    title = f"A simulated 1000 kg skid-steered vehicle, {options.duration:g} s"
    return write_report(
        path, log=log, calibration=calibration, evaluation=evaluation, title=title, command=options.command
    )
