# SPDX-License-Identifier: Apache-2.0
"""Writes the report of a benchmark run: machine, commands, tables, what is not measured, where it loses."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from losses import Loss, losses
from provenance import Provenance

from slipwise.files import write_text_whole

NOT_MEASURED = (
    "Other machines, compilers and operating systems; arm64.",
    "Energy, and the behaviour under real-time scheduling. Times are the best or the median of several runs.",
    "Memory of the C++ core apart from Python's; peak memory includes the log's file while it is mapped.",
    "Reading bags at full length: the longest logs are tidy CSV.",
    "Slopes: no log is judged apart for the gravity terms.",
    "Rivals other than the named bases, the vendor's multiplier, the static fit, numpy and filterpy.",
    "Terrain that changes within a log, but for robotino/table_gray.",
)


@dataclass(frozen=True)
class Section:
    """One benchmark as it was run."""

    title: str
    command: str
    seconds: float
    output: str
    failed: bool
    raw: str | None  # name of the JSON file with the raw figures


def write_report(
    folder: Path, machine: Provenance, sections: Sequence[Section], loads: tuple[float, float]
) -> Path:
    """Write REPORT.md and provenance.json beside the raw figures.

    Raises:
        OutputError: the folder cannot be written.
    """
    content = asdict(machine) | {"data_sha256": machine.data_sha256}
    write_text_whole(folder / "provenance.json", json.dumps(content, indent=1) + "\n")
    lines = [f"# Benchmark report, {folder.name}", "", *_machine_table(machine, loads), ""]
    for section in sections:
        lines += _section(section)
    lines += ["## Where slipwise loses", "", *_losses(losses(folder)), ""]
    lines += ["## What was not measured", "", *_bullets(NOT_MEASURED)]
    path = folder / "REPORT.md"
    write_text_whole(path, "\n".join(lines) + "\n")
    return path


def _machine_table(machine: Provenance, loads: tuple[float, float]) -> list[str]:
    rows = {
        "processor": f"{machine.processor}; {machine.cores} cores",
        "memory": f"{machine.memory_gigabytes:.1f} GB",
        "system": machine.system,
        "compiler": machine.compiler,
        "versions": ", ".join([machine.python, *(f"{name} {v}" for name, v in machine.packages.items())]),
        "commit": machine.commit,
        "real logs": f"{len(machine.data)} files, sha256 of their names and hashes `{machine.data_sha256}`"
        if machine.data
        else "none: SLIPWISE_DATA was not set",
        "load average": f"{loads[0]:.1f} before, {loads[1]:.1f} after (1 min; the benchmarks add up to "
        f"{machine.cores})",
    }
    return ["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows.items())]


def _section(section: Section) -> list[str]:
    raw = f" It writes {section.raw}." if section.raw else ""
    failed = " **It failed.**" if section.failed else ""
    return [
        f"## {section.title}",
        "",
        f"`{section.command}`, {section.seconds:.0f} s.{failed}{raw}",
        "",
        "```text",
        section.output.strip("\n"),
        "```",
        "",
    ]


def _losses(found: Sequence[Loss]) -> list[str]:
    if not found:
        return ["Nowhere in these figures."]
    return [
        line for loss in found for line in (f"- {loss.what}:", *(f"  - {place}" for place in loss.places))
    ]


def _bullets(sentences: Sequence[str]) -> list[str]:
    return [f"- {sentence}" for sentence in sentences]
