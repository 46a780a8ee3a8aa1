# SPDX-License-Identifier: Apache-2.0
"""The page is sent valid JSON of bounded size, whatever the numbers and texts are."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from live.sample_outputs import (
    driven_outputs,
    driven_status,
    next_moves,
    odometry_at,
    straight_path,
    surface_at,
    waiting_status,
)

from slipwise.live.outputs import Output, ParameterNow, SurfaceNow
from slipwise.live.watch.history import History
from slipwise.live.watch.web_snapshot import snapshot


def _shown(*outputs: Output) -> dict[str, Any]:
    history = History()
    for output in outputs:
        history.take(output)
    text = snapshot(history.seen())
    assert "\n" not in text
    return dict(json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is no JSON")))


def test_nothing_is_valid_too() -> None:
    shown = _shown()
    assert shown["status"] is None
    assert shown["path"]["robot"] is None


def test_a_drive_is_shown_with_its_parameters_paths_and_nis() -> None:
    shown, status = _shown(*driven_outputs()), driven_status()
    assert [p["name"] for p in shown["status"]["parameters"]] == [p.name for p in status.parameters]
    assert shown["status"]["stamp"] == f"{status.t:.1f} s"
    assert status.odometry is not None
    assert shown["path"]["robot"] == pytest.approx(status.odometry.pose, abs=1e-3)
    assert shown["path"]["driven"][0][-1] == pytest.approx(status.driven[-1, 0], abs=1e-3)
    assert len(shown["path"]["driven"][0]) <= 500
    assert shown["nis"][-1][0] == 0.0
    assert len(shown["nis"]) > 3
    assert len(shown["path"]["ellipses"]) >= 3


def test_moves_worth_driving_are_shown_in_words_with_bars() -> None:
    assert _shown(*driven_outputs())["next"] is None
    shown = _shown(*driven_outputs(), next_moves())
    first, second, third = shown["next"]["moves"]
    assert (first["v"], first["omega"], first["seconds"]) == (1.0, -0.8, 2.0)
    assert first["text"] == "forwards 1.00 m/s, turning right 0.80 rad/s"
    assert second["text"] == "backwards 0.50 m/s, straight"
    assert third["text"] == "on the spot, turning left 0.80 rad/s"
    assert [part["known"] == 1.0 for part in shown["next"]["sure"]] == [False, True]
    rows = {row["name"]: row["known"] for row in shown["status"]["parameters"]}
    assert rows["ang.w"] == 1.0
    assert 0.0 < rows["delay_omega"] < 1.0
    without = _shown(next_moves(moves=(), predictions=(), why="drive a slow curve first"))
    assert without["next"] == {"why": "drive a slow curve first", "moves": [], "sure": []}


def test_a_parameter_is_placed_in_standard_deviations_of_its_prior() -> None:
    p = ParameterNow("a", "s", 1.5, 0.25, 0.5, "estimated", 1.0, 1.25)
    (row,) = _shown(waiting_status(parameters=(p,)))["status"]["parameters"]
    assert (row["at"], row["spread"], row["appliedAt"]) == (1.0, 0.5, 0.5)
    (row,) = _shown(waiting_status(parameters=(replace(p, prior_std=0.0),)))["status"]["parameters"]
    assert (row["at"], row["spread"], row["appliedAt"]) == (None, None, None)


def test_an_ellipse_is_as_large_as_the_covariance_says() -> None:
    shown = _shown(straight_path(points=7))
    last = np.array(shown["path"]["ellipses"][-1])
    radius = math.sqrt(-2.0 * math.log(0.05))
    assert np.ptp(last[0]) / 2 == pytest.approx(radius * math.sqrt(3e-3), abs=2e-3)
    assert np.ptp(last[1]) / 2 == pytest.approx(radius * math.sqrt(12e-3), abs=2e-3)


def test_hostile_numbers_and_texts_are_sent_as_null_and_text() -> None:
    nowhere = replace(odometry_at(1.0), pose=np.array([math.nan, math.inf, 0.0]), since_pose=math.inf)
    path = straight_path()
    path.covariance[-1] = np.nan
    p = ParameterNow("</script>\ud800", "s", math.nan, math.nan, math.nan, "invalid", math.nan, math.inf)
    status = waiting_status(
        t=math.nan,
        vehicle="line\nbreak",
        parameters=(p,),
        odometry=nowhere,
        predicted=path,
        slip=np.full(3, np.nan),
        held_out=(math.nan,) * 4,
        driven=np.full((3, 3), np.inf),
    )
    shown = _shown(nowhere, status)
    assert shown["path"]["robot"] == [None, None, 0.0]
    assert shown["status"]["slip"][0]["value"] is None
    assert shown["status"]["vehicle"] == "line\nbreak"


def test_the_newest_measured_pose_stays_where_a_long_path_is_thinned() -> None:
    driven = np.column_stack((np.arange(12_345.0), np.zeros(12_345), np.zeros(12_345)))
    shown = _shown(waiting_status(driven=driven))
    assert len(shown["path"]["driven"][0]) <= 500
    assert shown["path"]["driven"][0][-1] == 12_344.0


def test_the_surface_is_named_where_surfaces_are_remembered() -> None:
    def shown(surface: SurfaceNow | None) -> str:
        return str(_shown(waiting_status(surface=surface))["status"]["surface"])

    assert shown(None) == ""
    assert shown(surface_at()) == "sand, 90 %"
    assert shown(surface_at(name="", probability=1.0)) == "a new surface, 100 %"
