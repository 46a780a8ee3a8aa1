# SPDX-License-Identifier: Apache-2.0
"""`slipwise fleet`: many logs of many robots, learned once each and looked at together."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.options import Json, SettingsFile, optional

if TYPE_CHECKING:
    from slipwise.fleet import ParameterFindings, Scheduler
    from slipwise.fleet.learn_fleet import Count

_MOST_UNUSABLE = 5  # logs whose reasons are printed; the page lists all


def fleet(
    logs: Annotated[
        list[str],
        typer.Argument(
            metavar="PLACE...",
            show_default=False,
            help="Logs, folders, patterns, addresses, or @FILE that lists some.",
        ),
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for rows, page and prior.")
    ] = Path("fleet"),
    name: Annotated[
        str, typer.Option(metavar="NAME", help="Name of the robot of all logs; default: the folder of a log.")
    ] = "",
    vehicle_type: Annotated[
        str, typer.Option("--type", metavar="NAME", help="Type of all robots, for the prior.")
    ] = "",
    settings: SettingsFile = None,
    workers: Annotated[int | None, optional("N", "Number of processes; default: one per processor.")] = None,
    scheduler: Annotated[
        str | None,
        optional("ADDRESS", "A Dask cluster (tcp://host:8786) in place of processes."),
    ] = None,
    json: Json = None,
) -> int:
    """Learn every log, keep a row per log and parameter, and show what the robots share and what stands out.

    DIR/rows is a Parquet data set by vehicle and month; DIR/fleet.html shows vehicles side by side, drift and
    odd ones; DIR/fleet.yaml is the prior of the next robot, for `slipwise calibrate --prior`. A second
    run learns only what is new: other bytes or other settings. Ctrl-C loses the logs at work, no more. Exit
    code 1: no log was usable.

    \b
    Examples:
      slipwise fleet logs/ -o fleet
      slipwise fleet "bags/*/*.mcap" --settings fleet.toml --workers 8
      slipwise fleet https://example.org/husky-1/a.mcap @more_logs.txt
      slipwise fleet /data/logs --scheduler tcp://10.0.0.1:8786
    """  # noqa: D301
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_files
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.fleet import Store, find_logs, findings_of, write_prior
    from slipwise.fleet.fleet_page import fleet_page, summary
    from slipwise.fleet.learn_fleet import learn_fleet

    out = Output(json)
    files = {"page": output / "fleet.html", "prior": output / "fleet.yaml"}
    refuse_unwritable(*files.values(), out.written_file, inputs=[settings])
    learns = _scheduler(scheduler, workers)
    found = find_logs(logs, vehicle=name)
    store = Store(output, _settings_hash(settings))
    mended = store.mend()
    for sentence in mended:
        out.line(sentence)
    with progress_bar("learning") as update:
        count = learn_fleet(
            found,
            store,
            learns,
            settings=settings,
            progress=lambda now: update(_left_text(now.seconds_left), now.done / now.of),
        )
    table, unusable = store.table(), store.unusable()
    findings = findings_of(table)
    _write(files["page"], fleet_page(table, findings, unusable))
    sentences, code = summary(table, findings, unusable), 0 if table else 1
    table.clear()  # its memory serves the prior
    write_prior(files["prior"], findings, store.knowledge(), vehicle_type=vehicle_type)
    out.document(_document(count, findings, unusable, files) | {"set_aside": mended, "exit_code": code})
    for sentence in sentences:
        out.line(sentence)
    left_out = [(str(entry["log"]), str(entry["failure"])) for entry in unusable[:_MOST_UNUSABLE]]
    for log, why in (*left_out, *count.failed, *count.copies):
        out.line(why if log in why else f"{log}: {why}")
    show_files(out, files | {"rows": output / "rows"})
    return code


def _scheduler(address: str | None, workers: int | None) -> Scheduler:
    from slipwise.fleet import ProcessScheduler

    if address is None:
        return ProcessScheduler(workers)
    from slipwise.fleet.dask_scheduler import DaskScheduler

    return DaskScheduler(address)


def _settings_hash(settings: Path | None) -> str:
    """Return the hash of the settings; refuse wrong ones once, before every worker does."""
    from slipwise.calibration import Settings, load_settings
    from slipwise.fleet.learned_rows import settings_hash

    read = Settings() if settings is None else load_settings(settings)
    read.bases()
    return settings_hash(read)


def _left_text(seconds: float) -> str:
    minutes = seconds / 60.0
    return f"{minutes:.0f} min left" if minutes >= 2.0 else f"{seconds:.0f} s left"


def _write(path: Path, text: str) -> None:
    from slipwise.files import write_text_whole

    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_whole(path, text)


def _document(
    count: Count,
    findings: tuple[ParameterFindings, ...],
    unusable: list[dict[str, Any]],
    files: dict[str, Path],
) -> dict[str, Any]:
    from dataclasses import asdict

    from slipwise.cli.document import head

    return head("fleet") | {
        "files": files,
        "count": asdict(count),
        "unusable": unusable,
        "findings": [asdict(finding) for each in findings for finding in each.findings],
        "vehicles": {
            each.parameter: dict(zip(each.vehicles, each.estimate.tolist(), strict=True)) for each in findings
        },
    }
