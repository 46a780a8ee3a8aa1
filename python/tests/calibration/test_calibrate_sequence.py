# SPDX-License-Identifier: Apache-2.0
"""A model remembers surfaces, and learning goes on from it."""

from __future__ import annotations

import pytest
from sample_slopes import Hills, hilly_log
from sample_surfaces import FIRM, LOOSE, floor_log, model_of_floors

from slipwise.calibration.calibrate_sequence import calibrate_sequence, settings_of
from slipwise.calibration.learned_sequence import SequenceOptions
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.settings import make_settings
from slipwise.calibration.settings_for_log import SLOPE_BASES
from slipwise.errors import LogError, ModelError, SettingsError
from slipwise.models import Model


@pytest.mark.slow
def test_a_log_names_its_surfaces_and_a_label_names_those_that_had_a_number() -> None:
    logs = [floor_log(FIRM, 1), floor_log(LOOSE, 2, terrain="sand"), floor_log(FIRM, 3, terrain="hall")]
    calibration, sequence = calibrate_sequence(logs, input="wheel")
    assert [log.surface for log in sequence.logs] == ["surface 1", "sand", "hall"]
    assert {each.name for each in calibration.model.content.surfaces} == {"hall", "sand"}
    assert calibration.model.content.labels is not None
    assert calibration.model.content.labels.right == 2.0


@pytest.mark.slow
def test_a_learner_of_measurements_begins_with_a_model() -> None:
    start = model_of_floors(FIRM, LOOSE, labels=("hall", "sand"))
    learner = MotionLearner("wheel", remember=True)
    learner.begin_with(start)
    assert [each.name for each in learner.surfaces()] == ["hall", "sand"]
    with pytest.raises(ModelError, match="of wheels, and these logs are of commands"):
        MotionLearner("command", remember=True).begin_with(start)


def bases_of(model: Model) -> set[str]:
    memory = model.content.surfaces[-1].memory
    assert memory is not None
    return set(memory.bases)


def test_the_first_log_decides_whether_terms_of_gravity_are_tried() -> None:
    hills, flat = hilly_log(1, Hills(seconds=60.0)), floor_log(FIRM, 1)
    on_hills, _ = calibrate_sequence([hills], input="command")
    assert not bases_of(on_hills.model).isdisjoint(SLOPE_BASES)
    assert "gy" in on_hills.model.to_yaml()
    on_flat, _ = calibrate_sequence([flat, hills], input="command")
    assert bases_of(on_flat.model).isdisjoint(SLOPE_BASES)
    begun, _ = calibrate_sequence([hills], options=SequenceOptions(start=on_flat.model))
    assert bases_of(begun.model).isdisjoint(SLOPE_BASES)


def test_what_has_no_memory_is_refused() -> None:
    log = floor_log(FIRM, 1)
    with pytest.raises(LogError, match="needs a log"):
        calibrate_sequence([])
    with pytest.raises(SettingsError, match="only the estimator 'average'"):
        calibrate_sequence([log], settings=make_settings({"estimator": "iekf", "basis": "edd-2"}))
    model = calibrate_sequence([log], input="wheel")[0].model
    assert settings_of(model).basis == "auto"
    forgot = type(model)(model.content.model_copy(update={"surfaces": []}))
    with pytest.raises(ModelError, match="remembers no surfaces"):
        calibrate_sequence([log], options=SequenceOptions(start=forgot))
    with pytest.raises(SettingsError, match="the surfaces were learned with"):
        calibrate_sequence(
            [log], settings=make_settings({"basis": "icr-3"}), options=SequenceOptions(start=model)
        )
