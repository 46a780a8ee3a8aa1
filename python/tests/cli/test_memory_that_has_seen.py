# SPDX-License-Identifier: Apache-2.0
"""`slipwise evaluate --memory` on a log that the model to begin with has learned."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from cli.conftest import Result
from sample_surfaces import FIRM, floor_log

from slipwise.logs import save_log

Slipwise = Callable[..., Result]


def test_a_log_that_the_memory_has_learned_is_marked_as_evaluate_marks_it(
    slipwise: Slipwise, folder: Path
) -> None:
    seen, fresh, model = folder / "seen.csv", folder / "fresh.csv", folder / "mem.yaml"
    save_log(floor_log(FIRM, 1), seen)
    save_log(floor_log(FIRM, 2), fresh)
    learn = ("calibrate", "--memory", "--input", "wheel", "--no-report")
    assert slipwise(*learn, seen, "-o", model).code == 0
    judge = ("evaluate", "--memory", "--model", model, "--horizons", "2")
    page = folder / "page.html"
    both = slipwise(*judge, seen, fresh, "--report", page).out
    assert "seen.csv †" in both
    assert "fresh.csv †" not in both
    said = "The model was learned from this very log: judge it on another drive."
    assert f"seen.csv: {said}" in both
    assert f"fresh.csv: {said}" not in both
    assert page.read_text(encoding="utf-8").count("not causal: has seen these windows") == 1
    alone = slipwise("evaluate", "--model", model, seen, "--horizons", "2").out
    explained = "† not causal: it has learned from the very segments it is judged on."
    assert explained in both
    assert explained in alone
    assert said in " ".join(alone.split())
    other = slipwise(*judge, fresh).out
    assert "†" not in other
    first, second = slipwise(*judge, seen, fresh, "--json", "-").json["logs"]
    assert [each["causal"] for each in first["scores"] if each["method"] == "auto"] == [False]
    assert all(each["causal"] for each in second["scores"])
