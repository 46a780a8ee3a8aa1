# SPDX-License-Identifier: Apache-2.0
"""The noise that other tools are given is that of predictions, the slip disturbance included."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_models import make_model, named

from slipwise.export.reference_drive import motion_covariance, slip_density
from slipwise.models import Model
from slipwise.prediction import predict

MADE = replace(
    named("edd-2", lon__V=-0.05, ang__w=-0.3), disturbance=(0.2, 0.3, 8.0), inflation={1.0: 1.4, 5.0: 2.0}
)


def exact(model: Model) -> Model:
    """The model with poses measured without noise."""
    noise = model.content.noise.model_copy(update={"pose_std_xy": 0.0, "pose_std_yaw": 0.0})
    return Model(model.content.model_copy(update={"noise": noise}))


@pytest.mark.parametrize("seconds", [1.0, 3.0])
def test_covariance_is_that_of_predict(seconds: float) -> None:
    model = exact(make_model(MADE))
    path = predict(model, [(0.0, 0.7, 0.3)], horizon=seconds)
    np.testing.assert_allclose(motion_covariance(model, (0.7, 0.3), seconds), path.covariance[-1], rtol=1e-9)


def test_white_noise_of_slip_that_wanders_is_larger_over_a_longer_time() -> None:
    model, still = make_model(MADE), make_model(replace(MADE, disturbance=None))
    short, long = (
        slip_density(model, (0.7, 0.3), seconds) / slip_density(still, (0.7, 0.3), seconds)
        for seconds in (1.0, 5.0)
    )
    assert (short[[0, 2]] > 1.05).all()
    assert (long[[0, 2]] > short[[0, 2]]).all()
