# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/ablation.py`: its table on simulated logs, and where its mechanisms stand."""

from __future__ import annotations

import json
from pathlib import Path

import ablation
import pytest
from mechanisms import CALIBRATION, LIMITS, MECHANISMS
from replay_score import ReplayScore
from tuning_constants import tuning_constants

from slipwise.calibration.settings import make_settings


def test_a_mechanism_is_switched_off_on_simulated_logs(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "ablation.json"
    monkeypatch.setattr(
        "sys.argv",
        ["ablation.py", "--mechanism", "baseline structure", "--json", str(path), "--only", "first"],
    )
    assert ablation.main() == 0
    printed = capsys.readouterr().out
    assert "From commands, 1 logs" in printed
    assert "baseline structure" in printed
    content = json.loads(path.read_text(encoding="utf-8"))
    assert set(content) == {LIMITS.variant.name, "baseline structure"}
    means = content["baseline structure"]["means"]
    assert 0.0 < means["command"]["position"] < 1.0
    assert means["wheel"]["logs"] == 1


def test_what_gains_from_one_input_gains() -> None:
    def scores(command: float, wheel: float) -> list[ReplayScore]:
        inside = (0.5, 0.9, 0.95)
        return [
            ReplayScore("a", name, 10, error, 0.1, inside, inside, 1.0)
            for name, error in (("command", command), ("wheel", wheel))
        ]

    default = scores(0.2, 0.3)
    assert ablation.largest_gain(scores(0.2, 0.33), default) == pytest.approx(10.0)
    assert ablation.largest_gain(scores(0.1, 0.2), default) == 0.0


def test_what_a_mechanism_names_is_there(subtests: pytest.Subtests) -> None:
    for mechanism in [*MECHANISMS, LIMITS, CALIBRATION]:
        with subtests.test(mechanism=mechanism):
            make_settings(dict(mechanism.variant.settings))
            assert set(mechanism.variant.constants) <= {constant.name for constant in tuning_constants()}
            if mechanism.files or mechanism.named:
                assert mechanism.lines > 1
