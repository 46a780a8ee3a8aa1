# SPDX-License-Identifier: Apache-2.0
"""Paths over surfaces that are seen ahead: by prediction, by rollouts, and by a controller."""

from __future__ import annotations

import numpy as np
import pytest
from sample_surfaces import FIRM, LOOSE, model_of_floors

from slipwise.errors import ModelError, SettingsError
from slipwise.models import Model, on_surface
from slipwise.planning import (
    Controller,
    MppiOptions,
    ReferencePath,
    Start,
    learned_motions,
    rollout,
)
from slipwise.prediction import predict
from slipwise.terrain_ahead import TerrainAhead

COMMANDS = np.array([[0.0, 0.5, 0.3], [1.0, 0.6, -0.2], [2.0, 0.5, 0.4]])
AHEAD = TerrainAhead([0.0, 1.0], {"hall": [1.0, 0.0], "sand": [0.0, 1.0]})


@pytest.fixture(scope="module")
def model() -> Model:
    return model_of_floors(FIRM, LOOSE, labels=("hall", "sand"))


def with_classes(model: Model) -> Model:
    hall, sand = model.content.surfaces
    surfaces = [
        hall.model_copy(update={"classes": {"white": 3.0}}),
        sand.model_copy(update={"classes": {"brown": 5.0, "white": 1.0}}),
    ]
    return Model(model.content.model_copy(update={"surfaces": surfaces}))


@pytest.mark.slow
def test_one_surface_all_along_is_the_model_on_it(model: Model) -> None:
    ahead = TerrainAhead([0.0], {"sand": 1.0})
    path = predict(model, COMMANDS, horizon=3.0, terrain_ahead=ahead)
    plain = predict(on_surface(model, "sand"), COMMANDS, horizon=3.0)
    np.testing.assert_allclose(path.poses, plain.poses, atol=1e-9)
    np.testing.assert_allclose(path.covariance, plain.covariance, rtol=1e-4, atol=1e-9)


@pytest.mark.slow
def test_a_path_follows_the_first_surface_up_to_the_edge(model: Model) -> None:
    path = predict(model, COMMANDS, horizon=4.0, terrain_ahead=AHEAD)
    hall, sand = (predict(on_surface(model, name), COMMANDS, horizon=4.0) for name in ("hall", "sand"))
    before = hall.t < 1.5
    np.testing.assert_allclose(path.poses[before], hall.poses[before], atol=1e-9)
    assert abs(path.poses[-1, 2] - hall.poses[-1, 2]) > 0.05
    turned = [float(each.poses[-1, 2] - each.poses[25, 2]) for each in (path, sand)]
    assert turned[0] == pytest.approx(turned[1], abs=0.01)


@pytest.mark.slow
def test_where_it_is_open_what_comes_the_covariance_says_so(model: Model) -> None:
    open_ahead = TerrainAhead([0.0, 1.0], {"hall": [1.0, 0.5], "sand": [0.0, 0.5]})
    never = TerrainAhead([0.0, 1.0], {"hall": [1.0, 0.0]})
    sure, mixed, new = (
        predict(model, COMMANDS, horizon=4.0, terrain_ahead=ahead) for ahead in (AHEAD, open_ahead, never)
    )
    assert mixed.covariance[-1, 2, 2] > 3.0 * sure.covariance[-1, 2, 2]
    assert new.covariance[-1, 2, 2] > 3.0 * sure.covariance[-1, 2, 2]
    np.testing.assert_allclose(mixed.covariance[5], sure.covariance[5], rtol=0.02, atol=1e-7)


@pytest.mark.slow
def test_a_class_leads_to_the_surfaces_that_it_was_felt_on(model: Model) -> None:
    told = with_classes(model)
    brown = TerrainAhead([0.0], {"brown": 1.0}, classes=True)
    odds = predict(told, COMMANDS, horizon=3.0, terrain_ahead=brown).poses[-1, 2]
    sand = predict(on_surface(told, "sand"), COMMANDS, horizon=3.0).poses[-1, 2]
    hall = predict(on_surface(told, "hall"), COMMANDS, horizon=3.0).poses[-1, 2]
    assert abs(odds - sand) < 0.3 * abs(odds - hall)
    unknown = TerrainAhead([0.0], {"blue": 1.0}, classes=True)
    wide = predict(told, COMMANDS, horizon=3.0, terrain_ahead=unknown)
    prior = predict(told, COMMANDS, horizon=3.0, terrain_ahead=TerrainAhead([0.0], {"sand": 0.0}))
    np.testing.assert_allclose(wide.poses, prior.poses)
    np.testing.assert_allclose(wide.covariance, prior.covariance)


@pytest.mark.slow
def test_a_controller_steers_for_the_surface_that_it_comes_to(model: Model) -> None:
    t = np.linspace(0.0, 6.0, 61)
    curve = ReferencePath(np.column_stack((2.0 * np.sin(0.25 * t), 2.0 * (1.0 - np.cos(0.25 * t)))), 0.5)
    options = MppiOptions(rollouts=256, periods=30, period=0.1)
    first = []
    for name in ("hall", "sand"):
        motions = learned_motions(model, terrain_ahead=TerrainAhead([0.0], {name: 1.0}))
        controller = Controller(motions, curve, options=options)
        for _ in range(20):
            command = controller.command((0.0, 0.0, 0.0), (0.5, 0.2))
        first.append(command[1])
    assert first[1] > first[0]
    with pytest.raises(SettingsError, match="no samples are drawn"):
        learned_motions(model, samples=2, terrain_ahead=AHEAD)


@pytest.mark.slow
def test_what_the_model_does_not_remember_is_refused(model: Model) -> None:
    with pytest.raises(ModelError, match=r"remembers no surface 'ice'.*it remembers hall, sand"):
        predict(model, COMMANDS, horizon=1.0, terrain_ahead=TerrainAhead([0.0], {"ice": 1.0}))
    bare = Model(model.content.model_copy(update={"surfaces": []}))
    with pytest.raises(ModelError, match="remembers no surfaces to come to"):
        rollout(bare, np.ones((1, 2, 2)), 0.1, start=Start(terrain_ahead=AHEAD))


def test_what_is_no_terrain_ahead_is_refused(subtests: pytest.Subtests) -> None:
    for distance, probability, said in [
        ([0.5], {"sand": 1.0}, "begin with 0"),
        ([0.0, 0.0], {"sand": 1.0}, "increase"),
        ([], {"sand": 1.0}, "begin with 0"),
        ([0.0], {}, "no surface is named"),
        ([0.0], {"sand": 0.7, "hall": 0.7}, "more than 1"),
        ([0.0], {"sand": -0.1}, "negative"),
        ([0.0, 1.0], {"sand": [0.1, 0.2, 0.3]}, "3 probabilities of sand for 2 stretches"),
        ([0.0], {"sand": float("nan")}, "not finite"),
        ([0.0, "x"], {"sand": 1.0}, "no numbers"),
    ]:
        with (
            subtests.test(distance=distance, probability=probability, said=said),
            pytest.raises(SettingsError, match=said),
        ):
            TerrainAhead(distance, probability)


def test_what_was_passed_is_no_longer_ahead() -> None:
    rest = AHEAD.after(0.4)
    np.testing.assert_allclose(np.asarray(rest.distance), [0.0, 0.6])
    passed = AHEAD.after(1.5)
    np.testing.assert_allclose(np.asarray(passed.distance), [0.0])
    assert np.asarray(passed.probability["sand"]).tolist() == [1.0]
    with pytest.raises(SettingsError, match="not a distance"):
        AHEAD.after(-1.0)
