# SPDX-License-Identifier: Apache-2.0
"""`slipwise simulate`: a simulated drive as a log."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from slipwise.cli.options import Duration, Json, Seed

SUMMARY = "Record a simulated drive."


def simulate(
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", help="The log: .mcap, .csv, .csv.gz or .parquet."),
    ],
    duration: Duration = 300.0,
    drive: Annotated[
        str, typer.Option(metavar="NAME", help="Command script: thesis, steps or dull.")
    ] = "thesis",
    terrain: Annotated[
        str, typer.Option(metavar="NAME", help="tyre-force, traction-law, or MuJoCo's own contact-friction.")
    ] = "tyre-force",
    seed: Seed = 1,
    pose_rate: Annotated[float, typer.Option(metavar="HZ", help="Rate of poses and wheel speeds.")] = 20.0,
    std_xy: Annotated[float, typer.Option(metavar="METRES", help="Noise of a measured position.")] = 0.01,
    std_yaw: Annotated[float, typer.Option(metavar="RADIANS", help="Noise of a measured heading.")] = 0.003,
    pose_delay: Annotated[
        float, typer.Option(metavar="SECONDS", help="How late the stamps of poses are.")
    ] = 0.0,
    json: Json = None,
) -> int:
    """Drive a simulated six-wheel, 1000 kg skid-steered vehicle and record it.

    The same options and seed give the same log.

    \b
    Examples:
      slipwise simulate -o drive.mcap
      slipwise simulate -o dull.csv --drive dull --duration 60
      slipwise simulate -o late.parquet --pose-delay 0.2 --std-xy 0.05 --seed 7
    """  # noqa: D301
    from slipwise.cli.document import head, log_part
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_files, show_notes
    from slipwise.cli.writable import refuse_unknown_log_format, refuse_unwritable
    from slipwise.logs import save_log
    from slipwise_sim import Scenario
    from slipwise_sim import simulate as run_simulation

    out = Output(json)
    refuse_unknown_log_format(output)
    refuse_unwritable(output, out.written_file)
    scenario = Scenario(
        duration=duration,
        drive=drive,
        terrain=terrain,
        pose_rate=pose_rate,
        std_xy=std_xy,
        std_yaw=std_yaw,
        pose_delay=pose_delay,
    )
    with progress_bar("simulating") as update:
        log = run_simulation(
            scenario, seed=seed, progress=lambda fraction: update("simulating", fraction)
        ).log
        save_log(log, output)
    out.document(head("simulate") | {"exit_code": 0, "files": {"log": output}} | log_part(log, log.left_out))
    show_notes(out, log.notes)
    show_files(out, {"log": output})
    return 0
