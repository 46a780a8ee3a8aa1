# SPDX-License-Identifier: Apache-2.0
"""What is known before a drive is the learner's prior or a model's posterior."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_models import make_model, named

from slipwise import _core
from slipwise.errors import ModelError, SettingsError
from slipwise.excitation import CommandSpace, knowledge_of, prior_knowledge

SPACE = CommandSpace(3.0, 2.0)


def test_every_slip_term_may_explain_three_tenths_of_the_motion() -> None:
    knowledge = prior_knowledge(SPACE, dynamics=False)
    std = dict(zip(knowledge.names, np.sqrt(np.diag(knowledge.covariance)), strict=True))
    assert len(std) == 10
    assert std["lon.V"] == pytest.approx(0.3)
    assert std["ang.V*w"] == pytest.approx(0.3 * 2.0 / 6.0)


def test_lag_and_delay_are_parameters_too() -> None:
    names = prior_knowledge(SPACE).names
    assert len(names) == 14
    assert any("time_constant" in name for name in names)


def test_unknown_basis_is_refused() -> None:
    with pytest.raises(SettingsError):
        prior_knowledge(SPACE, basis="odd")


def test_model_hands_over_its_mean_and_covariance() -> None:
    model = make_model(named("edd-2", ang__w=-0.3))
    knowledge = knowledge_of(model)
    np.testing.assert_array_equal(knowledge.mean, model.mean)
    np.testing.assert_array_equal(knowledge.covariance, model.covariance)
    assert (np.diag(knowledge.spread) >= np.diag(knowledge.covariance)).all()


def test_robots_differ_by_a_factor_of_what_is_likely() -> None:
    knowledge = prior_knowledge(SPACE)
    np.testing.assert_allclose(knowledge.spread_by(2.0).spread, 4.0 * knowledge.spread)
    np.testing.assert_array_equal(knowledge.spread_by(2.0).covariance, knowledge.covariance)


def test_a_force_that_is_fixed_to_the_map_is_refused() -> None:
    made = named("edd-2")
    windy = make_model(replace(made, basis=_core.with_force(made.basis, _core.ForceFrame.World)))
    with pytest.raises(ModelError, match="designed drives know no heading over the map"):
        knowledge_of(windy)
