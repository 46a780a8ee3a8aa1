# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/sensitivity.py`: what it varies, by how much, and in which order it prints."""

from __future__ import annotations

from pathlib import Path

import pytest
import sensitivity
from replay_score import ReplayScore
from tuning_constants import tuning_constants

from slipwise.cli.output import Output


def test_all_that_is_declared_is_listed(tmp_path: Path) -> None:
    (tmp_path / "cpp").mkdir()
    source = (
        "SLIPWISE_TUNING(kGain, 0.3);  // [s] why\n"
        "inline SLIPWISE_TUNING(kCount, std::size_t{8});  ///< how many\n"
    )
    (tmp_path / "cpp" / "filter.cpp").write_text(
        f"{source}constexpr double kOther = 1.0;\n", encoding="utf-8"
    )
    listed = [(c.name, c.value, c.meaning) for c in tuning_constants(tmp_path)]
    assert listed == [("filter.kGain", "0.3", "[s] why"), ("filter.kCount", "8", "how many")]


def test_settings_and_sources_are_varied_once_each() -> None:
    names = [constant.name for constant in sensitivity.constants()]
    assert len(names) == len(set(names))
    assert {"hypotheses.filter.iekf.huber", "disturbance.white", "structures.kPatience"} <= set(names)
    assert names
    assert not sensitivity.FRACTIONS - set(names)


def test_of_fractions_the_odds_are_varied() -> None:
    half = sensitivity.Constant("disturbance.white", "0.5")
    assert half.variant(2.0).numbers["disturbance.white"] * 0.5 == pytest.approx(2.0 / 3.0)
    assert half.variant(0.5).numbers["disturbance.white"] * 0.5 == pytest.approx(1.0 / 3.0)
    assert sensitivity.Constant("iekf.kUnknown", "1.0").variant(2.0).constants == {"iekf.kUnknown": 2.0}


def test_changes_are_relative_to_the_default() -> None:
    inside = (0.5, 0.9, 0.95)
    default = [ReplayScore("a", "wheel", 10, 0.2, 0.1, inside, inside, 1.0)]
    scores = [ReplayScore("a", "wheel", 10, 0.22, 0.09, (0.5, 0.88, 0.95), inside, 1.0)]
    change = sensitivity.change_of(scores, default)
    assert change.errors[2:] == pytest.approx((10.0, -10.0))
    assert change.coverage == pytest.approx(2.0)


def test_what_matters_most_comes_first(capsys: pytest.CaptureFixture[str]) -> None:
    def varied(name: str, percent: float, points: float = 0.0) -> sensitivity.Varied:
        row = sensitivity.Change((percent, 0.0, float("nan"), float("nan")), points)
        return sensitivity.Varied(name, "1", (row, None))

    rows = [varied("little", 0.1), varied("much", -3.0), varied("covers", 0.1, points=4.0)]
    sensitivity.show(Output(None), sensitivity.by_effect(rows))
    table, _, unimportant = capsys.readouterr().out.partition("Change no error")
    assert table.index("much") < table.index("little")
    assert "little" in unimportant
    assert "much" not in unimportant
    assert "covers" not in unimportant
