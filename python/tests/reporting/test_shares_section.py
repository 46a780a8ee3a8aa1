# SPDX-License-Identifier: Apache-2.0
"""The report shows what arrives of commands: numbers, and each window as a point."""

from __future__ import annotations

from pathlib import Path

from sample_logs import Drive, simulated_log

import slipwise as sw


def test_commands_against_the_body_are_drawn_where_the_log_has_commands(tmp_path: Path) -> None:
    log = simulated_log(Drive(seconds=90.0, lag=0.3, delay=0.2))
    pages = [
        sw.calibrate(log, input=name).report(tmp_path / f"{name}.html").read_text(encoding="utf-8")
        for name in ("command", "wheel")
    ]
    assert pages[0].count('data-figure="figure-commanded-speed"') == 1
    assert pages[0].count('data-figure="figure-commanded-yaw-rate"') == 1
    assert "Over this log, " in pages[0]
    assert "figure-commanded" not in pages[1]
    assert "The log does not say it: it has no commands" in pages[1]
