# SPDX-License-Identifier: Apache-2.0
"""The page of a plan in a headless Chromium without network."""

from __future__ import annotations

from pathlib import Path

import pytest
from planning.planning_samples import learned_model, walled_map
from reporting.browser import Browser
from reporting.page_layout import overlaps
from reporting.page_privacy import assert_sends_nothing

from slipwise.planning import RouteOptions, RoutePlanner
from slipwise.reporting.plan_drawing import Plan
from slipwise.reporting.plan_page import plan_page

START, GOAL = (1.5, 6.0, 0.0), (5.0, 6.4, 0.1)
pytestmark = pytest.mark.slow

STATE = "document.documentElement.dataset"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    grid = walled_map()
    route = RoutePlanner(learned_model(), grid, search=RouteOptions(radius=0.3)).route(START, GOAL)
    path = tmp_path_factory.mktemp("plan") / "plan.html"
    path.write_text(plan_page(Plan(route, grid, 0.3, START, GOAL, "A plan")), encoding="utf-8")
    return path


@pytest.mark.parametrize("width", [1400, 420])
def test_map_and_commands_are_drawn_without_error_and_fit_the_width(
    browser: Browser, page: Path, width: int
) -> None:
    browser.open(page, width=width)
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.problems == []
    assert browser.value(f"{STATE}.drawn") == "2"
    assert browser.value("document.documentElement.scrollWidth") == width
    assert overlaps(browser) == []
    shown = browser.value("document.getElementById('figure-plan')._fullLayout.yaxis.range")
    assert shown == pytest.approx([0.0, 8.0], abs=1e-6)  # the map and nothing beside it


def test_no_button_sends_anything(browser: Browser, page: Path) -> None:
    browser.open(page, width=1280)
    assert_sends_nothing(browser, page)
