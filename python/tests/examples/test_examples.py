# SPDX-License-Identifier: Apache-2.0
"""Every example runs as it stands and checks itself."""

import re
import runpy
from functools import cache
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))

pytest.importorskip("mujoco", reason="the examples simulate a robot, which needs MuJoCo")
slipwise_sim = pytest.importorskip("slipwise_sim")
simulate_once = cache(slipwise_sim.simulate)  # several learn from the same drive


def test_examples_are_numbered_from_one_without_gaps() -> None:
    numbers = [int(re.match(r"(\d\d)_", script.name)[1]) for script in SCRIPTS]  # type: ignore[index]
    assert numbers == list(range(1, len(SCRIPTS) + 1))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_runs_and_its_claims_hold(
    script: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(slipwise_sim, "simulate", simulate_once)
    text = script.read_text(encoding="utf-8")
    assert text.count("\nassert ") >= 1, "an example asserts something about its result"
    assert "# %% [markdown]" in text, "an example is in percent format"
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out.strip(), "an example shows what it found"
