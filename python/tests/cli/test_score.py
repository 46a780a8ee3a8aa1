# SPDX-License-Identifier: Apache-2.0
"""`slipwise score` scores a prediction file on the log that it is of, and says what is wrong with one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from cli.conftest import Result

Slipwise = Callable[..., Result]


def test_a_file_of_evaluate_gets_the_same_scores(slipwise: Slipwise, drive_csv: Path) -> None:
    asked = ("--methods", "none,edd-2", "--horizons", "2")
    expected = slipwise("evaluate", drive_csv, *asked, "--predictions", "p.csv", "--json", "-").json["scores"]
    result = slipwise("score", "p.csv", drive_csv, "--json", "-")
    assert (result.code, result.err) == (0, "")
    for score, before in zip(result.json["scores"], expected, strict=True):
        assert {name: score[name] for name in ("position", "nis", "coverage", "position_ratio")} == {
            name: before[name] for name in ("position", "nis", "coverage", "position_ratio")
        }
    shown = slipwise("score", "p.csv", drive_csv)
    assert "After 2 s, from commands" in shown.out


def test_a_file_of_another_log_is_one_line(slipwise: Slipwise, drive_csv: Path) -> None:
    Path("p.csv").write_text("run,method,t_start,t_end,horizon,dx,dy,dyaw\nx,mine,0,2,2,0,0,0\n")
    result = slipwise("score", "p.csv", drive_csv)
    assert result.code == 2
    assert result.line.startswith("1 predictions over 2 s are of no window of the log (p.csv, line 2, run x")
