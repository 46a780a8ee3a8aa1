# SPDX-License-Identifier: Apache-2.0
"""`slipwise doctor`: what contradicts what in a log, why, and which line to change."""

from __future__ import annotations

from typing import TYPE_CHECKING

from slipwise.cli.options import Changes, Json, Logs, SettingsFile, chosen_settings, takes_log_options
from slipwise.number_text import count_text

if TYPE_CHECKING:
    from slipwise.cli.output import Output
    from slipwise.logs import Log, LogOptions
    from slipwise.logs.findings.diagnose import Diagnosis
    from slipwise.logs.findings.finding import Finding


@takes_log_options
def doctor(
    logs: Logs,
    log_options: LogOptions,
    settings: SettingsFile = None,
    changes: Changes = None,
    json: Json = None,
) -> int:
    """Say what is wrong with a robot's wiring: clocks, topics, units, signs, encoders, drive, poses.

    Reads each log once and learns nothing. Every finding has a number that shows it, the cause, and the
    option of slipwise or the parameter of the robot's software that cures it. `calibrate`, `inspect` and
    `live` say the same. The exit code is 1 where something was found.

    \b
    Examples:
      slipwise doctor drive.mcap
      slipwise doctor drive.bag --pose-topic /rtk/odom
      slipwise doctor monday.csv tuesday.csv --json -
    """  # noqa: D301
    from slipwise.cli.output import Output
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.logs.findings.diagnose import diagnose

    out = Output(json)
    chosen = chosen_settings(settings, changes)
    refuse_unwritable(out.written_file, inputs=(*logs, *log_options.files, settings))
    found = [diagnose(path, log_options, sensor=chosen.sensor_extrinsics.pose) for path in logs]
    code = int(any(each.found for each in found))
    out.document(_document(found, code))
    for diagnosis in found:
        _show(out, diagnosis)
    return code


def _document(found: list[Diagnosis], code: int) -> dict[str, object]:
    from dataclasses import asdict

    from slipwise.cli.document import head

    logs = [{"path": each.path, "findings": [asdict(one) for one in each.found]} for each in found]
    return head("doctor") | {"exit_code": code, "logs": logs}


def _show(out: Output, diagnosis: Diagnosis) -> None:
    looked = "" if diagnosis.log is None else f" ({_looked_at(diagnosis.log)})"
    count = count_text(len(diagnosis.found), "finding") if diagnosis.found else "nothing found"
    out.line(f"{diagnosis.path}: {count}{looked}")
    show_findings(out, diagnosis.found)


def show_findings(out: Output, found: tuple[Finding, ...]) -> None:
    """Show each finding with what cures it."""
    for each in found:
        out.line(f"  {each.kind}: {each.sentence}")
        for advice in each.advice:
            out.line(f"    {advice}")


def _looked_at(log: Log) -> str:
    """Say what was looked at."""
    parts = {
        "commands": sum(len(run.commands) for run in log.runs if run.commands is not None),
        "wheel speeds": sum(len(run.wheels) for run in log.runs if run.wheels is not None),
        "poses": sum(len(each) for run in log.runs for each in (run.poses, *run.others.values())),
    }
    return ", ".join(f"{count} {name}" if count else f"no {name}" for name, count in parts.items())
