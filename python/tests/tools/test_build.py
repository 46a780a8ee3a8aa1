# SPDX-License-Identifier: Apache-2.0
"""The build says how far it is, and what failed."""

import io
import re
import sys

import pytest
from tools.build import PROCESSOR_SECONDS, Job, announcement, cost, ninja_progress, pip_progress, watch


def test_steps_of_ninja_and_of_pip_are_recognised() -> None:
    assert ninja_progress("[3/90] Building CXX object a.o") == "3 of 90"
    assert ninja_progress("warning: something") == ""
    assert pip_progress("Collecting numpy>=1.26 (from -r run.txt)") == "numpy"
    assert pip_progress("Installing collected packages: typer, rich") == "typer"
    assert pip_progress("  Using cached numpy.whl") == ""


def test_jobs_run_side_by_side_to_their_end() -> None:
    jobs = [Job(name, ((sys.executable, "-c", "print('[1/2] x')"),), ninja_progress) for name in "ab"]
    watch(jobs, io.StringIO())
    assert [(job.state, job.code, job.log) for job in jobs] == [("done", 0, ["[1/2] x"])] * 2


def test_a_job_ends_at_the_first_command_that_fails_and_keeps_what_it_said() -> None:
    fails = (sys.executable, "-c", "import sys; print('why'); sys.exit(3)")
    job = Job("compiling", (fails, (sys.executable, "-c", "print('never')")), ninja_progress)
    watch([job], io.StringIO())
    assert (job.state, job.code, job.log) == ("failed", 3, ["why"])


def test_the_first_build_says_at_its_start_what_it_does_and_costs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 4)
    text = announcement()
    assert f"{PROCESSOR_SECONDS} s of processor time" in text
    assert f"{round(PROCESSOR_SECONDS / 4, -1):.0f} s on 4 cores" in text


def test_the_first_build_says_at_its_end_what_it_cost() -> None:
    busy = (sys.executable, "-c", "import time\nwhile time.process_time() < 1.1: pass")
    watch([Job("compiling", (busy,), ninja_progress)], io.StringIO())
    said = re.fullmatch(r"compiled and installed in 12 s, (\d+) s of processor time", cost(12.3))
    assert said is not None
    assert int(said[1]) >= 1
