# SPDX-License-Identifier: Apache-2.0
"""The README's figure is drawn from a real log, on which slipwise is ahead of two fitted numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from docs.figures.make_figures import HORIZON, INPUT, LEARNED, LOG, PLAIN, SHOWN, SIMPLE, main, parts, starts

import slipwise as sw


def test_without_logs_the_script_says_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SLIPWISE_DATA", raising=False)
    with pytest.raises(SystemExit, match="SLIPWISE_DATA is not set"):
        main(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_paths_are_of_the_run_that_was_not_learned_and_differ(real_log_dir: Path) -> None:
    log = sw.open_log(real_log_dir / LOG)
    earlier, last = parts(log)
    assert last not in earlier.runs
    times = starts(last)
    assert len(set(times)) == SHOWN
    assert min(times) > last.poses.t[0]
    assert max(times) + HORIZON < last.poses.t[-1]


@pytest.mark.slow
def test_slipwise_is_clearly_ahead_on_the_log_that_is_drawn(real_log_dir: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    options = sw.EvaluationOptions(horizons=(HORIZON,), methods=(PLAIN, SIMPLE, LEARNED))
    log = sw.open_log(real_log_dir / LOG)
    evaluation = sw.evaluate(log, input=INPUT, options=options)
    learned, simple = (evaluation.score(name, HORIZON).position for name in (LEARNED, SIMPLE))
    assert learned.high < 0.5 * simple.low
    picture = main(tmp_path)
    assert 10_000 < picture.stat().st_size < 150_000
    assert np.frombuffer(picture.read_bytes()[:4], np.uint8).tolist() == [0x89, *b"PNG"]
