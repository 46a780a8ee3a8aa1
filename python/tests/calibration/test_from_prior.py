# SPDX-License-Identifier: Apache-2.0
"""Learning that begins with a fleet's prior errs less at first, and leaves one that the robot contradicts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from fleet.fleet_samples import gentle_log, known_fleet, robot_slip
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings, calibrate
from slipwise.calibration.from_prior import KnownFleet, calibrate_from
from slipwise.errors import ModelError, SettingsError
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.fleet import write_prior
from slipwise.models import load_model

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> KnownFleet:
    path = tmp_path_factory.mktemp("fleet") / "fleet.yaml"
    return KnownFleet.load(write_prior(path, (), known_fleet(), vehicle_type="rover"))


def errors(seed: int, fleet: KnownFleet, seconds: float) -> tuple[float, float]:
    """Heading errors after 2 s without and with the prior, of a drive without noise that turns more."""
    log = gentle_log(seed, seconds)
    drive = Drive(seconds=60.0, seed=seed + 1000, basis=_core.named_basis("edd-2"), alpha=robot_slip(seed))
    models = {
        "without": calibrate(log, input="wheel").model,
        "with": calibrate_from(log, fleet, input="wheel")[0].model,
    }
    options = EvaluationOptions((2.0,), ("without", "with"), model=models)
    judged = evaluate(simulated_log(drive), input="wheel", options=options)
    return judged.score("without", 2.0).heading.mean, judged.score("with", 2.0).heading.mean


def test_with_little_or_gentle_driving_the_error_is_smaller(fleet: KnownFleet) -> None:
    for seconds, most in ((30.0, 0.6), (120.0, 0.8)):
        pairs = np.array([errors(seed, fleet, seconds) for seed in range(50, 55)])
        assert pairs[:, 1].mean() <= most * pairs[:, 0].mean(), seconds


def test_the_model_says_what_it_began_with_and_is_read_back(fleet: KnownFleet, tmp_path: Path) -> None:
    calibration, known = calibrate_from(gentle_log(60, 30.0), fleet, input="wheel")
    assert known is not None
    assert any("4 robots of type rover" in note for note in calibration.notes)
    model = load_model(calibration.model.save(tmp_path / "m.yaml"))
    assert model.content.provenance.prior is not None
    assert model.content.provenance.prior.path == str(fleet.path)
    without = calibrate(gentle_log(60, 30.0), input="wheel").model
    assert "prior:" not in without.save(tmp_path / "n.yaml").read_text()


def test_a_robot_of_another_kind_leaves_the_prior_away(fleet: KnownFleet) -> None:
    other = gentle_log(61, 120.0, slip=(0.1, 0.3))
    calibration, _ = calibrate_from(other, fleet, input="wheel")
    assert any("was left away" in note for note in calibration.notes)
    assert calibration.model.to_yaml() == calibrate(other, input="wheel").model.to_yaml()


def test_without_a_prior_it_is_what_calibrate_does() -> None:
    log = gentle_log(62, 30.0)
    assert (
        calibrate_from(log, None, input="wheel")[0].model.to_yaml()
        == calibrate(log, input="wheel").model.to_yaml()
    )


def test_a_prior_that_does_not_fit_is_a_clear_error(fleet: KnownFleet, tmp_path: Path) -> None:
    log = gentle_log(63, 30.0)
    with pytest.raises(ModelError, match="the prior is of wheels, and this is learned from commands"):
        calibrate_from(log, fleet, input="command")
    with pytest.raises(ModelError, match="other terms or parameters"):
        calibrate_from(log, fleet, input="wheel", settings=Settings(basis="drive-9"))
    with pytest.raises(SettingsError, match="only the estimator"):
        calibrate_from(log, fleet, settings=Settings(estimator="iekf", basis="edd-2"))
    lonely = yaml.safe_load(fleet.path.read_text()) | {"start": None}
    (tmp_path / "one.yaml").write_text(yaml.safe_dump(lonely))
    with pytest.raises(ModelError, match="fewer than two robots"):
        calibrate_from(log, KnownFleet.load(tmp_path / "one.yaml"))
