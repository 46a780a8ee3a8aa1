# SPDX-License-Identifier: Apache-2.0
"""A force in a model: told from slip or not, said in words, gone with time and on another day."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_models import make_model, named

from slipwise import _core
from slipwise.errors import ModelError, SettingsError
from slipwise.export.targets import export_model
from slipwise.ground import Grade
from slipwise.models import Model, load_model
from slipwise.models.body_force import Frame, force_names, force_parts, force_sentence, without_force
from slipwise.models.schema import BodyForceSection
from slipwise.planning import rollout
from slipwise.prediction import predict

FRAMES: dict[Frame, _core.ForceFrame] = {"body": _core.ForceFrame.Body, "world": _core.ForceFrame.World}
AHEAD = np.array([[0.0, 1.0, 0.0]])


def forced(frame: Frame, **values: float) -> Model:
    made = named("edd-2", lon__V=-0.05, ang__w=-0.2)
    names = {name.replace("__", ".").replace("_V_", "(V)"): value for name, value in values.items()}
    basis = _core.with_force(made.basis, FRAMES[frame])
    model = make_model(replace(made, basis=basis, values={**made.values, **names}))
    law = BodyForceSection(frame=frame, time_constant=60.0, std=0.03)
    return Model(model.content.model_copy(update={"body_force": law}))


def parts(frame: Frame, mean: list[float], std: float, *unknown: str) -> dict[str, object]:
    names = list(force_names(frame))
    known = [name not in unknown for name in names]
    found = force_parts(frame, names, np.array(mean), std**2 * np.eye(len(names)), known)
    return {part.name: part for part in found}


def test_a_part_shows_where_it_is_far_from_zero() -> None:
    found = force_parts(
        "body",
        force_names("body"),
        np.array([-0.04, -0.02, 0.003, 0.0, 0.0, 0.0]),
        1e-4 * np.eye(6),
        [True] * 6,
    )
    ahead, left, turn = found
    assert (ahead.name, ahead.shows, ahead.drift, ahead.std) == ("ahead", True, -0.04, pytest.approx(0.01))
    assert not left.shows
    assert turn.unit == "rad/m"
    assert "A force pushes the robot" in force_sentence(found)
    assert "-0.040 ± 0.010 m/m" in force_sentence(found)


def test_what_a_drive_does_not_tell_from_slip_gets_no_number() -> None:
    found = parts("body", [-0.5, 0.0, 0.0, 0.0, 0.0, 0.0], 0.01, "lon.abs(V)")
    assert "not identifiable" in str(found["ahead"])
    assert "0.5" not in str(found["ahead"])


def test_wind_pushes_along_the_map() -> None:
    # x: lon cos, lat -sin; y: lon sin, lat cos
    values = {"lon.abs(V)*cos(yaw)": 0.03, "lat.abs(V)*sin(yaw)": -0.05}
    found = parts("world", [values.get(name, 0.0) for name in force_names("world")], 0.005)
    assert "along x of the poses: 0.040 ± 0.004 m/m" in str(found["x"])
    assert "may be none" in str(found["y"])


def test_the_file_keeps_the_law_of_a_force_and_has_none_without(tmp_path: Path) -> None:
    model = forced("world")
    assert load_model(model.save(tmp_path / "m.yaml")).content == model.content
    assert "body_force" not in make_model(named("edd-2")).to_yaml()


def test_a_prediction_carries_a_force_that_fades() -> None:
    model = forced("body", lon__abs_V_=-0.1)
    now, later, gone = (
        predict(model, AHEAD, horizon=2.0, force_age=age).poses[-1, 0] for age in (0.0, 60.0, 1e4)
    )
    assert now == pytest.approx(2.0 * (0.95 - 0.1 * np.exp(-1.0 / 60.0)), abs=1e-6)
    assert later == pytest.approx(2.0 * (0.95 - 0.1 * np.exp(-61.0 / 60.0)), abs=1e-6)
    assert gone == pytest.approx(2.0 * 0.95, abs=1e-6)
    spread = [predict(model, AHEAD, horizon=2.0, force_age=age).covariance[-1, 0, 0] for age in (0.0, 1e4)]
    assert spread[1] > spread[0]  # where it is then, nobody knows


def test_impossible_forces_are_refused() -> None:
    model = forced("body")
    with pytest.raises(SettingsError, match="now or before"):
        predict(model, AHEAD, horizon=1.0, force_age=-1.0)
    with pytest.raises(SettingsError, match="two finite numbers"):
        predict(model, AHEAD, horizon=1.0, known_force=(np.nan, 0.0))
    with pytest.raises(SettingsError, match="level ground"):
        predict(model, AHEAD, horizon=1.0, known_force=(1.0, 0.0), ground=Grade(slope=0.1, downhill=0.0))


def test_wind_is_felt_by_the_heading_at_the_start() -> None:
    model = forced("world", **{"lat.abs(V)*cos(yaw)": 0.1})
    east, west = (predict(model, AHEAD, horizon=2.0, at=(0.0, 0.0, yaw)).poses[-1, 1] for yaw in (0.0, np.pi))
    assert east == pytest.approx(0.2, abs=5e-3)
    assert west == pytest.approx(-0.2, abs=5e-3)


def test_another_day_has_slip_without_the_force() -> None:
    model = forced("body", lon__abs_V_=-0.1)
    without = without_force(model)
    assert [p.name for p in without.content.parameters] == ["lon.V", "ang.w"]
    assert without.mean.tolist() == [-0.05, -0.2]
    assert without_force(without) is without
    text = export_model(model, "c-header", name="m.yaml").text
    assert text == export_model(without, "c-header", name="m.yaml").text


def test_slip_that_was_not_told_from_a_force_holds_both() -> None:
    model = forced("body", lon__abs_V_=-0.02)
    names = [p.name for p in model.content.parameters]
    slip, force = names.index("lon.V"), names.index("lon.abs(V)")
    covariance = model.covariance.copy()
    covariance[slip, force] = covariance[force, slip] = -0.999 * covariance[slip, slip]
    unknown = [
        p.model_copy(update={"identifiable": p.name != "lon.abs(V)"}) for p in model.content.parameters
    ]
    joint = Model(model.content.model_copy(update={"parameters": unknown, "covariance": covariance.tolist()}))
    value = without_force(joint)["lon.V"]
    assert value.value == pytest.approx(-0.05 - 0.999 * 0.02)
    assert value.std < 0.1 * model["lon.V"].std


def test_planning_refuses_a_force_that_turns_with_the_map() -> None:
    straight = np.dstack((np.ones((1, 10)), np.zeros((1, 10))))
    path = rollout(forced("body", lon__abs_V_=-0.1), straight, 0.1).path
    assert path is not None
    assert path[0, -1, 0] == pytest.approx(0.85, abs=1e-3)
    with pytest.raises(ModelError, match="heading") as caught:
        rollout(forced("world"), np.ones((1, 10, 2)), 0.1)
    assert "without_force" in caught.value.advice
