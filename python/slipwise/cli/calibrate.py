# SPDX-License-Identifier: Apache-2.0
"""`slipwise calibrate`: from logs to a model file with a verdict."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.options import (
    Basis,
    Changes,
    Input,
    Json,
    Labels,
    Logs,
    Report,
    Runs,
    SettingsFile,
    chosen_settings,
    optional,
    takes_log_options,
)
from slipwise.number_text import count_text

if TYPE_CHECKING:
    from slipwise.calibration import Calibration
    from slipwise.cli.learn_logs import LearnedLogs, Opened
    from slipwise.cli.output import Output
    from slipwise.logs import Log, LogOptions


@takes_log_options
def calibrate(
    logs: Logs,
    log_options: LogOptions,
    output: Annotated[
        Path | None, optional("MODEL.yaml", "Write the model here too.", "-o", "--output")
    ] = None,
    input_name: Input = None,
    basis: Basis = None,
    settings: SettingsFile = None,
    changes: Changes = None,
    memory: Annotated[
        bool,
        typer.Option(
            "--memory",
            help="The logs are drives of one robot in the order of time: remember surfaces, recall them and "
            "keep them in the model file. A model file (.yaml) before the logs is continued.",
        ),
    ] = False,
    surface: Labels = None,
    prior: Annotated[
        Path | None,
        optional("FLEET.yaml", "Start from what `slipwise fleet` learned of this type of robot."),
    ] = None,
    report: Report = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no HTML report.")] = False,
    runs: Runs = Path("runs"),
    json: Json = None,
) -> int:
    """Learn the motion model of the robot in one or several logs.

    Learns causally, as it would on the robot, and judges itself on what it had not seen. Model, settings,
    result and report go into a new folder below `runs`; -o writes the model to a place of your choice as
    well. The model is written even where the verdict is bad; it says so itself, and the exit code is 1.

    \b
    Examples:
      slipwise calibrate drive.mcap -o model.yaml
      slipwise calibrate drive.mcap --pose-topic /rtk/odom --input command
      slipwise calibrate monday.csv tuesday.csv.gz --basis odd-even-10 --no-report
      slipwise calibrate drive.csv --set estimator=iekf --basis drive-5
      slipwise calibrate towing.mcap --set body_force.frame=body
      slipwise calibrate two_minutes.mcap --prior fleet/fleet.yaml
      slipwise calibrate --memory sand.csv asphalt.csv -o monday.yaml
      slipwise calibrate --memory mon.yaml tue.csv -o tue.yaml --surface sand
      slipwise calibrate --memory a.csv b.csv --surface labels.csv -o mon.yaml
      slipwise calibrate drive.csv --no-report --json - | jq .verdict
    """  # noqa: D301
    from slipwise.cli.command_line import command_line
    from slipwise.cli.learn_logs import Asked, learn_logs, opened
    from slipwise.cli.memory_options import label_files
    from slipwise.cli.output import Output, to_json
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.run_folder import run_folder, write_settings
    from slipwise.cli.tables import show_killed_runs
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.files import write_text_whole

    out = Output(json)
    chosen = chosen_settings(settings, changes, basis) if settings or changes or basis or not memory else None
    read = (*logs, *log_options.files, settings, prior, *label_files(surface))
    refuse_unwritable(output, report, out.written_file, inputs=read)
    asked = Asked(
        logs,
        log_options,
        input_name,
        chosen,
        memory,
        tuple(surface or ()),
        prior,
    )
    with progress_bar("reading") as update:
        given = opened(asked)
        with run_folder(runs, "calibrate") as folder:
            learned = learn_logs(given, lambda fraction: update("learning", fraction))
            log, calibration, chosen = given.log, learned.calibration, learned.settings
            files = {
                "model": calibration.model.save(folder / "model.yaml"),
                "settings": write_settings(folder, chosen),
            }
            if calibration.mounts:
                files["mounts"] = folder / "sensor_mounts.txt"
                write_text_whole(files["mounts"], _mounts(calibration))
            if calibration.smoothed is not None:
                files["smoothed"] = calibration.smoothed.save(folder / "smoothed.csv")
            if not no_report:
                from slipwise.reporting.session import report_calibration

                files["report"] = report or folder / "report.html"
                update("writing the report", 1.0)
                calibration = report_calibration(
                    files["report"],
                    log,
                    calibration,
                    chosen,
                    command=command_line(),
                    model=output or files["model"],
                )
            if output is not None:
                files["model"] = calibration.model.save(output)
            document = _document(log, calibration, files) | _memory_part(given, learned)
            write_text_whole(folder / "result.json", to_json(document))
            out.document(document)
    _show(out, calibration, files | {"run folder": folder})
    _show_memory(out, given, learned)
    show_killed_runs(out, runs)
    return _exit_code(calibration)


def _mounts(calibration: Calibration) -> str:
    """Return where further sources of poses sit, for other tools."""
    from slipwise.export.mounts import mounts_text

    origin = calibration.model.content.provenance
    beside = calibration.mounts[0].beside or "the first source"
    logs = [f"log: {log.path} (sha256 {log.sha256[:16]})" for log in origin.logs]
    head = f"slipwise {origin.slipwise_version}: where sources of poses sit, beside {beside}"
    return mounts_text([mount.mounted() for mount in calibration.mounts], (head, *logs))


def _exit_code(calibration: Calibration) -> int:
    return 0 if calibration.verdict.good else 1


def _document(log: Log, calibration: Calibration, files: dict[str, Path]) -> dict[str, Any]:
    from slipwise.cli.document import calibration_part, head, log_part, mounts_part, verdict_part
    from slipwise.cli.other_input import other_input_part

    verdict = {"exit_code": _exit_code(calibration), "verdict": verdict_part(calibration.verdict)}
    return (
        head("calibrate")
        | verdict
        | {"files": files}
        | calibration_part(calibration)
        | log_part(log, calibration.left_out)
        | {"notes": list(calibration.notes), "mounts": mounts_part(calibration)}
        | other_input_part(calibration.model, calibration)
    )


def _memory_part(given: Opened, learned: LearnedLogs) -> dict[str, Any]:
    """Return what became of surfaces; empty if there was no memory."""
    from dataclasses import asdict

    from slipwise.cli.document import memory_part

    sequence = learned.sequence
    if sequence is None:
        return {}
    visited = zip(given.names, sequence.logs, strict=True)
    return {
        "visits": [
            {"log": name, "surface": log.surface, "changes": [asdict(change) for change in log.changes]}
            for name, log in visited
        ],
        **memory_part(sequence),
    }


def _show_memory(out: Output, given: Opened, learned: LearnedLogs) -> None:
    from slipwise.cli.tables import show_memory_changes, show_surfaces

    if learned.sequence is not None:
        for name, log in zip(given.names, learned.sequence.logs, strict=True):
            out.line(f"{name} ended on {log.surface or 'a surface that is open'}.")
        show_surfaces(out, learned.sequence.surfaces)
        show_memory_changes(out, given.names, learned.sequence)


def _show(out: Output, calibration: Calibration, files: dict[str, Path]) -> None:
    from slipwise.calibration.next_step import after_learning
    from slipwise.cli.other_input import show_other_input
    from slipwise.cli.tables import (
        show_alarms,
        show_confounded,
        show_files,
        show_left_out,
        show_notes,
        show_parameters,
        show_shares,
        show_summary,
        show_verdict,
    )
    from slipwise.models.summary import summarise

    content = calibration.model.content
    learned, summary = content.provenance, summarise(calibration.model)
    out.line(
        f"Learned from {content.input}s, basis {content.slip.basis}: "
        f"{count_text(learned.learned_segments, 'segment')}, {learned.learned_seconds:.0f} s of driving."
    )
    show_summary(out, summary)
    show_verdict(out, calibration.verdict, after_learning(calibration.verdict, files["model"]))
    show_other_input(out, calibration.model, files["model"])
    show_files(out, files)
    show_notes(out, calibration.notes)
    show_left_out(out, calibration.left_out)
    if calibration.history is not None:
        show_alarms(out, calibration.history)
    show_confounded(out, calibration.verdict.confounded)
    show_shares(out, calibration.model)
    show_parameters(out, summary.parameters)
