# SPDX-License-Identifier: Apache-2.0
"""The section of the ground along the drive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of, figures_of
from reporting.synthetic_results import Results, make_results, with_model, without_history

from slipwise.calibration.result import History
from slipwise.calibration.surface_course import SurfaceCourse
from slipwise.models.schema import SurfaceSection
from slipwise.reporting.sections.ground import GroundSection

MUD = SurfaceSection(
    name="<mud>",
    seconds=90.0,
    segments=45,
    visits=2,
    speed=1.5,
    yaw_rate=0.6,
    slip=[-0.1, -0.3],
    covariance=[[1e-4, 0.0], [0.0, 1e-4]],
)


def history_of(results: Results) -> History:
    history = results.calibration.history
    assert history is not None
    return history


def with_history(results: Results, **changes: object) -> Results:
    history = replace(history_of(results), **changes)  # type: ignore[arg-type]
    return replace(results, calibration=replace(results.calibration, history=history))


def test_without_a_memory_stretches_between_alarms_are_told_apart() -> None:
    html = GroundSection().html(contents_of(make_results()))
    data = figures_of(html)["figure-ground"]["data"]
    assert [trace["name"] for trace in data[:-1]] == ["stretch 1", "stretch 2", "stretch 3"]


def test_with_a_memory_the_surfaces_are_drawn() -> None:
    results = make_results()
    history = history_of(results)
    count = len(history.t)
    probability = np.column_stack((np.linspace(1.0, 0.0, count), np.linspace(0.0, 1.0, count)))
    course = SurfaceCourse(history.run, history.t, ("sand", "mud"), probability, history.alarm)
    html = GroundSection().html(contents_of(with_history(results, surfaces=course)))
    data = figures_of(html)["figure-ground"]["data"]
    assert [trace["name"] for trace in data[:-1]] == ["sand", "mud"]


def test_the_table_of_surfaces_is_escaped() -> None:
    html = GroundSection().html(contents_of(with_model(make_results(), surfaces=[MUD])))
    assert "&lt;mud&gt;" in html
    assert "<mud>" not in html


def test_a_drive_without_alarms_or_windows_says_so() -> None:
    results = make_results()
    calm = with_history(results, alarm=np.zeros(len(history_of(results).t), np.bool_))
    assert "No change of terrain was found" in GroundSection().html(contents_of(calm))
    assert "not learned window by window" in GroundSection().html(contents_of(without_history(results)))
