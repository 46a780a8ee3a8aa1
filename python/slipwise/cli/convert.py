# SPDX-License-Identifier: Apache-2.0
"""`slipwise convert`: any log as a tidy table or as MCAP."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import Json, Logs, SettingsFile, takes_log_options

if TYPE_CHECKING:
    from slipwise.logs import LogOptions


@takes_log_options
def convert(
    logs: Logs,
    log_options: LogOptions,
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", help="The new log: .csv, .csv.gz, .parquet or .mcap."),
    ],
    settings: SettingsFile = None,
    json: Json = None,
) -> int:
    """Write one or several logs as one tidy table, or as MCAP; says what was guessed and what was left out.

    \b
    Examples:
      slipwise convert drive.mcap -o drive.csv
      slipwise convert monday.bag tuesday.db3 -o both.parquet --pose-topic /rtk/odom
      slipwise convert wheels.csv -o drive.mcap --wheel-radius 0.165 --track 0.555
      slipwise convert run.mcap -o run.csv --poses lidar_tum.txt --pose-clock-offset auto
    """  # noqa: D301
    from slipwise.cli.document import head, log_part
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_files, show_left_out, show_notes
    from slipwise.cli.writable import refuse_unknown_log_format, refuse_unwritable
    from slipwise.logs import open_log, save_log

    out = Output(json)
    refuse_unknown_log_format(output)
    refuse_unwritable(output, out.written_file, inputs=(*logs, log_options.poses, settings))
    with progress_bar("reading") as update:
        log = open_log(*logs, options=log_options)
        update("writing", 0.5)
        save_log(log, output)
    out.document(head("convert") | {"exit_code": 0, "files": {"log": output}} | log_part(log, log.left_out))
    show_notes(out, log.notes)
    show_left_out(out, log.left_out)
    show_files(out, {"log": output})
    return 0
