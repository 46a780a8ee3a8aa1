# SPDX-License-Identifier: Apache-2.0
"""A model file holds the slip disturbance, so that predictions from it hold the fraction that they state."""

from __future__ import annotations

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings, calibrate
from slipwise.calibration.predictions import normalised_squared, residual
from slipwise.calibration.prepared_run import WindowSet, collect_windows, prepare_run
from slipwise.models import Model, load_model
from slipwise.prediction import predict
from slipwise.student import fraction_inside

SETTINGS = Settings(basis="edd-2", learn_clock_offset=False)


def drive(seed: int, seconds: float) -> Drive:
    """A drive whose fractions of V and w disturbance by 0.1, over some 8 s."""
    return Drive(
        seconds=seconds,
        seed=seed,
        basis=_core.named_basis("edd-2"),
        alpha=(-0.08, -0.3),
        disturbance=(0.1, 8.0),
        pose_std=(0.01, 0.005),
        speeds=(0.3, 1.5),
    )


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Model]:
    """Each learned from a drive of its own, saved, and read; by the drive's seed."""
    folder = tmp_path_factory.mktemp("models")
    logs = {seed: simulated_log(drive(seed, 1800.0)) for seed in (1, 21, 22, 23, 31, 32, 33, 34)}
    learned = {seed: calibrate(log, input="wheel", settings=SETTINGS).model for seed, log in logs.items()}
    return {seed: load_model(model.save(folder / f"{seed}.yaml")) for seed, model in learned.items()}


def held_out(seed: int, seconds: float) -> list[WindowSet]:
    """Windows of other drives."""
    drives = [prepare_run(simulated_log(drive(100 * seed + k, 300.0)), "wheel") for k in range(4)]
    return [collect_windows(each, seconds, SETTINGS.rules()) for each in drives]


@pytest.mark.slow
def test_the_file_says_that_slip_wanders_and_how_far(models: dict[int, Model]) -> None:
    for model in models.values():
        disturbance = model.content.slip_disturbance
        assert disturbance is not None
        assert disturbance.segment == SETTINGS.segment_length("wheel")
        assert disturbance.candidates[0].weight < 0.01  # of slip that does not
        stds = np.sqrt(np.diag(model.covariance_over(0.01) - model.covariance))
        assert stds[:2] == pytest.approx(0.1, rel=0.4)
        assert not stds[2:].any()


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [2.0, 5.0])
def test_held_out_ellipsoids_hold_their_share(models: dict[int, Model], seconds: float) -> None:
    inside, without = [], []
    for seed, model in models.items():
        still = Model(model.content.model_copy(update={"slip_disturbance": None}))
        for windows in held_out(seed, seconds):
            inside += shares_inside(model, windows).tolist()
            without += shares_inside(still, windows).tolist()
    for fraction, tolerance in ((0.5, 0.04), (0.9, 0.03), (0.95, 0.02)):
        assert np.mean(np.array(inside) <= fraction) == pytest.approx(fraction, abs=tolerance)
        assert np.mean(np.array(without) <= fraction) < fraction - 0.15


def shares_inside(model: Model, windows: WindowSet) -> np.ndarray:
    """Fraction of the smallest ellipsoid of each prediction from the file that holds where the robot was."""
    nis, dof = [], []
    for i in range(len(windows)):
        inputs = windows.drive[int(windows.position[i])].inputs
        start, end = float(windows.start[i]), float(windows.end[i])
        path = predict(model, inputs, horizon=end - start, start=start)
        missed = residual(windows.measured[i : i + 1], path.poses[-1:])
        nis.append(normalised_squared(missed, path.covariance[-1:])[0])
        dof.append(path.dof[-1])
    return fraction_inside(np.array(nis), np.array(dof))
