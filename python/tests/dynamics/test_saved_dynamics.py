# SPDX-License-Identifier: Apache-2.0
"""A file of learned parameters is what another drive begins with, and other files are refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from dynamics.sample_systems import CART, ride

from slipwise.dynamics import Parameter, learn_dynamics, load_dynamics
from slipwise.errors import ModelError


def test_a_drive_begins_with_what_another_one_learned(tmp_path: Path) -> None:
    made = ride(1, seconds=20.0)
    learned = learn_dynamics(CART, made.inputs, made.measurements)
    begun = load_dynamics(learned.save(tmp_path / "cart.yaml"), CART)
    assert [p.value for p in begun.parameters] == pytest.approx([p.value for p in learned.parameters])
    assert [p.std for p in begun.parameters] == pytest.approx([p.std for p in learned.parameters])
    assert [p.unit for p in begun.parameters] == [p.unit for p in CART.parameters]


def test_other_files_are_refused(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for text, message in [
        ("slipwise_model: 4\n", "not a dynamics file"),
        ("slipwise_dynamics: 1\n", "parameters none"),
        ("slipwise_dynamics: 1\nparameters: [{name: drag, value: 1, std: 1}]\n", "parameters drag"),
        (
            "slipwise_dynamics: 1\nparameters: [{name: drag, value: .nan, std: 1}, {name: gain}]\n",
            "drag has no value",
        ),
        (
            "slipwise_dynamics: 1\nparameters: [{name: drag, value: 1, std: 0}, {name: gain}]\n",
            "drag has no value",
        ),
    ]:
        with subtests.test(text=text, message=message):
            path = tmp_path / "cart.yaml"
            path.write_text(text, encoding="utf-8")
            with pytest.raises(ModelError, match=message):
                load_dynamics(path, CART)


def test_dynamics_with_other_names_are_refused(tmp_path: Path) -> None:
    made = ride(1, seconds=5.0)
    path = learn_dynamics(CART, made.inputs, made.measurements).save(tmp_path / "cart.yaml")
    other = replace(CART, parameters=(Parameter("mass", 1.0, 1.0), CART.parameters[1]))
    with pytest.raises(ModelError, match="the dynamics mass, gain"):
        load_dynamics(path, other)
