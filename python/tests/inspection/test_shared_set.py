# SPDX-License-Identifier: Apache-2.0
"""What is written beside a shared table is enough to predict and to score."""

from __future__ import annotations

import json
from pathlib import Path

from sample_logs import Drive, simulated_log

from slipwise.evaluation import score_predictions
from slipwise.inspection import Stated, check_strictly, files_beside, write_beside
from slipwise.logs import open_log, save_log


def test_the_files_beside_a_table_keep_to_the_format_and_can_be_scored(tmp_path: Path) -> None:
    table = tmp_path / "drive.parquet"
    save_log(simulated_log(Drive(seconds=40.0)), table)
    done: list[float] = []
    stated = Stated("CC0-1.0", "simulated", "simulated")
    write_beside(table, stated, anonymised=False, progress=lambda _, part: done.append(part))
    beside = files_beside(table)
    assert {path.name for path in tmp_path.iterdir()} == {table.name, *(p.name for p in beside.values())}
    assert done == sorted(done)
    assert check_strictly(table) == ()
    assert json.loads(beside["schema"].read_text())["fields"][0]["name"] == "run"
    scored = score_predictions(beside["windows"], open_log(table))
    assert [score.position_ratio[0] for score in scored.scores] == [1.0] * 3
