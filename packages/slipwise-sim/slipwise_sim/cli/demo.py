# SPDX-License-Identifier: Apache-2.0
"""`slipwise demo`: a simulated robot's model learned and judged, with a report."""

from __future__ import annotations

import contextlib
import math
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.cli.options import Duration, Folder, Json, Runs, Seed
from slipwise.number_text import number_text

if TYPE_CHECKING:
    from slipwise.cli.output import Output
    from slipwise_sim.demo import DemoResult

SUMMARY = "See it work: a simulated robot, learned and judged."
FILES = ("drive.mcap", "model.yaml", "report.html", "settings.toml", "result.json")
SHOWN_HORIZONS = (2.0, 5.0)  # [s]


def demo(
    output: Folder = None,
    duration: Duration = 300.0,
    seed: Seed = 1,
    runs: Runs = Path("runs"),
    json: Json = None,
) -> int:
    """Simulate a drive, learn the robot's motion model from its bag, and compare it with today's practice.

    A six-wheel, 1000 kg skid-steered vehicle is driven for five minutes with RTK-like poses; the bag, the
    model and an HTML report are kept. Everything is learned from commands: they are all that a planner knows.

    \b
    Examples:
      slipwise demo
      slipwise demo --output demo --duration 120 --seed 7
    """  # noqa: D301
    from slipwise.calibration import Settings
    from slipwise.cli.command_line import command_line
    from slipwise.cli.document import calibration_part, evaluation_part, head, log_part, verdict_part
    from slipwise.cli.output import Output, to_json
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.run_folder import run_folder, write_settings
    from slipwise.cli.tables import show_killed_runs
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.files import write_text_whole
    from slipwise_sim.demo import DemoOptions, run_demo

    out = Output(json)
    refuse_unwritable(out.written_file, *(output / name for name in FILES if output is not None))
    with progress_bar("simulating") as update:
        place = run_folder(runs, "demo") if output is None else contextlib.nullcontext(output)
        with place as folder:
            result = run_demo(folder, DemoOptions(duration, seed, command_line()), progress=update)
            files = {
                "bag": result.bag,
                "model": result.model,
                "report": result.report,
                "settings": write_settings(folder, Settings()),
            }
            verdict = result.calibration.verdict
            document = (
                head("demo")
                | {"exit_code": 0 if verdict.good else 1, "verdict": verdict_part(verdict), "files": files}
                | calibration_part(result.calibration)
                | evaluation_part(result.evaluation)
                | log_part(result.log, result.calibration.left_out)
            )
            files["result"] = folder / "result.json"
            write_text_whole(files["result"], to_json(document))
            out.document(document)
    _show(out, result, files)
    show_killed_runs(out, runs)
    return 0 if verdict.good else 1


def _show(out: Output, result: DemoResult, files: dict[str, Path]) -> None:
    from slipwise.calibration.next_step import after_learning
    from slipwise.cli.output import Column
    from slipwise.cli.tables import show_files, show_summary, show_verdict
    from slipwise.models.summary import summarise
    from slipwise_sim.demo.run_demo import VENDOR_WHEEL_SEPARATION_MULTIPLIER

    names = {
        "none": "none",
        "vendor": f"vendor, separation x {VENDOR_WHEEL_SEPARATION_MULTIPLIER:g}",
        "edd-2": "edd-2, with lag and delay",
        "auto": "slipwise",
    }
    evaluation = result.evaluation
    horizons = [horizon for horizon in SHOWN_HORIZONS if horizon in evaluation.horizons]
    columns = [Column("method", whole=True)]
    columns += [
        Column(f"{what}, {h:g} s", True) for h in horizons for what in ("position [m]", "heading [deg]")
    ]
    rows = []
    for method in evaluation.methods:
        scores = [evaluation.score(method, horizon) for horizon in horizons]
        errors = [e for s in scores for e in (s.position.mean, math.degrees(s.heading.mean))]
        cells = [number_text(error) for error in errors]
        rows.append((names[method], *cells))
    windows = ", ".join(f"{evaluation.score('none', h).windows} of {h:g} s" for h in horizons)
    caption = f"Mean errors over held-out segments ({windows}), learned only from what came before each."
    out.table("How far predictions from commands alone miss", columns, rows, caption=caption)
    show_summary(out, summarise(result.calibration.model))
    verdict = result.calibration.verdict
    show_verdict(out, verdict, after_learning(verdict, files["model"]))
    show_files(out, files)
