# SPDX-License-Identifier: Apache-2.0
"""Compiles the core while pip fetches what slipwise needs, then installs slipwise; shows how far both are."""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from typing import TextIO

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/package"
PIP = (sys.executable, "-m", "pip", "install")
NINJA_STEP = re.compile(r"^\[(\d+)/(\d+)\]")
PIP_STEP = re.compile(r"^(?:Collecting|Downloading|Installing collected packages) *:? *([\w.-]*)")
PROCESSOR_SECONDS = 360  # of the first compilation and installation by GCC 12, without a cache of a compiler
EVERY = 20.0  # s between lines where nobody watches; a terminal has one line that changes


@dataclass
class Job:
    """Commands that run one after another, and what they say of their progress."""

    name: str
    commands: tuple[Sequence[str | Path], ...]
    says: Callable[[str], str]
    state: str = "..."
    log: list[str] = field(default_factory=list)
    code: int = 0

    def run(self) -> None:
        """Run the commands until one fails."""
        for command in self.commands:
            with subprocess.Popen(
                command,
                cwd=ROOT,
                text=True,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
            ) as process:
                for line in process.stdout or ():
                    self.log.append(line.rstrip())
                    self.state = self.says(line) or self.state
            self.code = process.returncode
            if self.code:
                self.state = "failed"
                return
        self.state = "done"


def ninja_progress(line: str) -> str:
    """Return "3 of 90" for a line of ninja that says so, else nothing."""
    step = NINJA_STEP.match(line)
    return f"{step[1]} of {step[2]}" if step else ""


def pip_progress(line: str) -> str:
    """Return what pip works on, else nothing."""
    step = PIP_STEP.match(line)
    return (step[1] or "unpacking")[:24] if step else ""


def watch(jobs: Sequence[Job], out: TextIO) -> None:
    """Run the jobs side by side, saying now and then how far each is."""
    threads = [Thread(target=job.run, daemon=True) for job in jobs]
    start, said = time.monotonic(), 0.0
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        time.sleep(0.2)
        seconds = time.monotonic() - start
        text = f"{', '.join(f'{job.name} {job.state}' for job in jobs)} ({seconds:.0f} s)"
        if out.isatty():
            print(
                f"\r\x1b[K{text}"[: os.get_terminal_size(out.fileno()).columns + 3],
                end="",
                file=out,
                flush=True,
            )
        elif seconds - said > EVERY:
            said = seconds
            print(text, file=out, flush=True)
    print("\r\x1b[K" if out.isatty() else "", end="", file=out, flush=True)


def compilation() -> Job:
    """Return the job that compiles the core and its Python extension."""
    configure = ("cmake", "--preset", "package")
    compile_all = ("cmake", "--build", BUILD, "--target", "_core", "_core_stub")
    return Job("compiling", (configure, compile_all), ninja_progress)


def downloads(parts: Sequence[str]) -> Job:
    """Return the job that installs the requirements of `parts` of pyproject.toml."""
    names: list[str | Path] = [sys.executable, ROOT / "tools/requirements.py", *parts]
    needed = subprocess.run(names, check=True, capture_output=True, text=True).stdout.split("\n")
    pins = ("--constraint", ROOT / "constraints.txt")
    return Job("installing", ((*PIP, *pins, *filter(None, needed)),), pip_progress)


def installation() -> Job:
    """Return the job that installs slipwise itself, editable; the core is compiled by then."""
    options = ("--no-index", "--no-deps", "--no-build-isolation", "--editable", ".")
    return Job("installing slipwise", ((*PIP, *options),), pip_progress)


def announcement() -> str:
    """Return what the first build does and costs."""
    cores = os.cpu_count() or 1
    return (
        "compiling the C++ core, once, while pip installs what slipwise needs: about "
        f"{PROCESSOR_SECONDS} s of processor time, {round(PROCESSOR_SECONDS / cores, -1):.0f} s "
        f"on {cores} cores"
    )


def cost(seconds: float) -> str:
    """Return what the commands so far took, to be compared with the announcement."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (
        f"compiled and installed in {seconds:.0f} s, {used.ru_utime + used.ru_stime:.0f} s of processor time"
    )


def main(parts: list[str]) -> int:
    """Build; `parts` of pyproject.toml are installed beside, where any are named."""
    new = not (BUILD / "build.ninja").exists()
    start = time.monotonic()
    if new:
        print(announcement(), flush=True)
    first = [compilation(), *([downloads(parts)] if parts else [])]
    for jobs in (first, [installation()]):
        watch(jobs, sys.stdout)
        for job in jobs:
            if job.code:
                print(
                    "\n".join(job.log[-40:]),
                    f"error: {job.name} failed; the lines above say why",
                    sep="\n",
                    file=sys.stderr,
                )
                return 1
    if new:
        print(cost(time.monotonic() - start), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
