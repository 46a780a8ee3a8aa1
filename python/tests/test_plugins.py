# SPDX-License-Identifier: Apache-2.0
"""Where a package beside slipwise is not installed, what it adds is refused by a command that installs it."""

from __future__ import annotations

from pathlib import Path

import pytest
from sample_logs import Drive, simulated_log

from slipwise import plugins
from slipwise.calibration import make_settings
from slipwise.cli.main import run
from slipwise.errors import SlipwiseError
from slipwise.evaluation import EvaluationOptions, evaluate

ROOT = Path(__file__).resolve().parents[2]
INSTALL = "pip install . ./packages/slipwise-sim ./packages/slipwise-thesis"


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Slipwise without packages beside it."""
    monkeypatch.setattr(plugins, "added", lambda group: {})
    monkeypatch.setattr("slipwise.cli.main.added", lambda group: {})


@pytest.mark.usefixtures("alone")
def test_an_estimator_of_a_missing_package_is_refused() -> None:
    with pytest.raises(SlipwiseError, match="'iekf' comes with the package slipwise-thesis") as refused:
        make_settings({"estimator": "iekf"})
    assert str(refused.value).endswith(INSTALL)


@pytest.mark.usefixtures("alone")
@pytest.mark.parametrize("name", ["slip-ratio-ekf", "surface-bayesian", "batch", "iekf"])
def test_a_method_of_a_missing_package_is_refused(name: str) -> None:
    log = simulated_log(Drive(seconds=20.0))
    with pytest.raises(SlipwiseError, match=f"'{name}' comes with the package slipwise-thesis") as refused:
        evaluate(log, input="wheel", options=EvaluationOptions(horizons=(2.0,), methods=("none", name)))
    assert str(refused.value).endswith(INSTALL)


@pytest.mark.usefixtures("alone")
def test_a_log_is_evaluated_without_the_packages() -> None:
    log = simulated_log(Drive(seconds=60.0))
    methods = evaluate(log, input="wheel", options=EvaluationOptions(horizons=(2.0,))).methods
    assert "auto" in methods
    assert "batch" not in methods


@pytest.mark.usefixtures("alone")
@pytest.mark.parametrize("verb", ["demo", "reproduce"])
def test_a_verb_of_a_missing_package_is_refused(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([verb]) == 2
    printed = " ".join(capsys.readouterr().err.split())
    assert f"'{verb}' comes with the package" in printed
    assert "pip install . ./packages/slipwise-sim" in printed


def test_the_packages_named_exist_and_declare_what_they_add() -> None:
    for (group, name), package in plugins._PACKAGES.items():
        assert package in (ROOT / "packages" / package / "pyproject.toml").read_text(encoding="utf-8")
        assert name in plugins.added(group), f"{package} adds no {name} to {group}"
