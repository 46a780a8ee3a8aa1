# SPDX-License-Identifier: Apache-2.0
"""A simulated log in `benchmarks/push_latency.py`: every push and prediction is counted in a histogram."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import push_latency
import pytest


def test_all_times_are_in_a_bin_up_to_the_longest() -> None:
    us = np.array([0.2, 1.0, 1.1, 99.0, 100.0, 101.0, 5000.0])
    bins = push_latency.histogram(us)
    edges = [edge for edge, _ in bins]
    assert sum(count for _, count in bins) == len(us)
    assert edges[0] == 1.0
    assert edges[-2] < us.max() <= edges[-1]
    np.testing.assert_allclose(np.diff(np.log10(edges)), 1.0 / push_latency.BINS_PER_DECADE)
    up_to_a_hundred = sum(count for edge, count in bins if edge < 100.1)
    assert up_to_a_hundred == 5


def test_every_push_is_timed(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "latency.json"
    monkeypatch.setattr("sys.argv", ["push_latency.py", "--only", "first", "--json", str(path)])
    assert push_latency.main() == 0
    assert "From wheels" in capsys.readouterr().out
    logs = json.loads(path.read_text(encoding="utf-8"))["logs"]
    assert [log["input"] for log in logs] == ["wheel", "command"]
    for log in logs:
        assert 3590 <= log["pushes"]["count"] <= 3600
        for kind in (log["pushes"], log["predictions"]):
            assert sum(count for _, count in kind["histogram"]) == kind["count"] > 0
            assert kind["mean"] <= kind["most"] <= kind["longest"]
