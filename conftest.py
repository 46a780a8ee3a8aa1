# SPDX-License-Identifier: Apache-2.0
"""What all tests share: real logs, a browser, a real ROS 2, and a count of the tests without logs."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from reporting.browser import Browser, find_browser

# Small matrices are slower on several threads, whose waiting takes a busy processor from other tests.
# The libraries read this when NumPy is first imported, which is later; processes that tests start inherit it.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

_NO_DATA = "SLIPWISE_DATA is not set: no real logs"


#: Files of slow tests that take longest: they run first, so that no process is left with one at the end.
LONGEST = (
    *("test_matrix", "test_faults", "test_hostile_files", "test_contradicted_streams", "test_examples"),
    *("test_live_on_ros", "test_code_in_pages", "test_causality", "test_mounts", "test_interruption"),
    *("test_same_verdict", "test_replay", "test_live", "test_bag_faults", "test_hour_of_day", "test_checks"),
    *("test_covariance", "test_force_recovery", "test_disturbed_model", "test_findings", "test_closed_loop"),
    *("test_hillside", "test_trailer_recovery", "test_ros_package", "test_figures", "test_chapter6"),
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the longest files first."""
    place = {name: number for number, name in enumerate(LONGEST)}
    items.sort(key=lambda item: place.get(item.path.stem, len(place)))


@pytest.fixture(scope="session")
def real_log_dir() -> Path:
    """Return the folder of real logs; skip without it, or fail where SLIPWISE_REQUIRE_DATA=1 asks for it."""
    folder = os.environ.get("SLIPWISE_DATA", "")
    if folder and Path(folder).is_dir():
        return Path(folder)
    reason = f"SLIPWISE_DATA names no folder: {folder}" if folder else _NO_DATA
    if os.environ.get("SLIPWISE_REQUIRE_DATA") == "1":
        pytest.fail(f"{reason}, and SLIPWISE_REQUIRE_DATA=1 asks for them", pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def ros_python() -> Path:
    """Return the Python that has rclpy; skip without it, or fail where SLIPWISE_REQUIRE_ROS=1 asks for it.

    It is that of SLIPWISE_ROS_VENV, or of `.venv-ros`, and has what is built of ros/.
    """
    folder = Path(os.environ.get("SLIPWISE_ROS_VENV") or Path(__file__).parent / ".venv-ros")
    if (folder / "installed.txt").exists():
        return folder / "bin" / "python"
    reason = f"there is no ROS 2 for tests in {folder} (`make ros` installs it)"
    if os.environ.get("SLIPWISE_REQUIRE_ROS") == "1":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def opened_browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Open a browser once; skip without one, or fail where SLIPWISE_REQUIRE_BROWSER=1 asks for it."""
    program = find_browser()
    if program is None:
        reason = "there is no Chromium on the PATH (Debian: apt install chromium)"
        if os.environ.get("SLIPWISE_REQUIRE_BROWSER") == "1":
            pytest.fail(reason)
        pytest.skip(reason)
    with Browser(program, tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture(scope="module")
def browser(opened_browser: Browser) -> Iterator[Browser]:
    """Give a module the browser, and leave it without a page, without network and light."""
    yield opened_browser
    opened_browser.go("about:blank", width=1280)
    opened_browser.prefer("light")
    opened_browser.connect(False)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many tests of real logs were skipped."""
    skipped = terminalreporter.stats.get("skipped", [])
    count = sum("SLIPWISE_DATA" in str(report.longrepr) for report in skipped)
    if count:
        terminalreporter.write_line(f"{count} tests of real logs skipped: {_NO_DATA}", yellow=True)
