# SPDX-License-Identifier: Apache-2.0
"""No string of a model file reaches code, keys or markup of a generated file, whichever string it is."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from sample_models import make_model, named

from slipwise.errors import ModelError
from slipwise.export import TARGETS, ExportOptions, Target, export_model
from slipwise.models import Model, load_model
from slipwise.planning import GridMap, LatticeOptions, RouteOptions, RoutePlanner, write_lattice
from slipwise.reporting.plan_drawing import Plan
from slipwise.reporting.plan_page import plan_page

HOSTILE = (
    '*/\n#error INJECTED\nint pwn(void){return system("id");}\n/*',
    "\n      INJECTED: 1\n# ",
    '</script><script>INJECTED()</script><img src=x onerror="INJECTED()">',
    "\\\n??/\n\u2028INJECTED\u202e\x00\x1b[2J",
    'x" } INJECTED: [1',
)
COMMAND = replace(named("edd-2", ang__w=-0.3), commands=True)
WHEEL = named("edd-2", ang__w=-0.3)
SOURCES = {
    target.name: COMMAND if target.name in ("mppi", "robot-localization", "px4", "ardupilot") else WHEEL
    for target in TARGETS
}
VERSIONS = ExportOptions(ros_distro="jazzy", px4="1.17", ardupilot="4.6")

Place = tuple[str | int, ...]


def full(made_from: Any) -> dict[str, Any]:
    """Return the content of a model file in which every list of strings has one."""
    content = make_model(made_from).content.model_dump(mode="json")
    content["weights"] = {"edd-2": 1.0}
    content["provenance"]["settings"] = {"basis": "edd-2", "nested": {"key": "text"}}
    content["verdict"] |= {
        "not_identifiable": ["lon.V"],
        "advice": ["Drive on."],
        "confounded": [{"first": "lon.V", "second": "ang.w", "correlation": 0.95}],
        "timing": "The delays are those from commands to poses.",
    }
    return content


def strings(value: Any, place: Place = ()) -> Iterator[Place]:
    """Yield where strings are, those that are keys of free tables too (as a place that ends in "")."""
    if isinstance(value, str):
        yield place
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from strings(item, (*place, key))
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from strings(item, (*place, i))


KEYS: tuple[Place, ...] = (("weights",), ("provenance", "settings"))


def injected(content: dict[str, Any], place: Place, text: str) -> dict[str, Any]:
    """Return the content with another string at one place; with another key for a free table."""
    again: dict[str, Any] = json.loads(json.dumps(content))
    at: Any = again
    for part in place[:-1]:
        at = at[part]
    if place in KEYS:
        at[place[-1]] = {text: 1.0}
    else:
        at[place[-1]] = text
    return again


def loaded(content: dict[str, Any], path: Path) -> Model | None:
    """Return the model of a file with this content; None where it is refused."""
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    try:
        return load_model(path)
    except ModelError:
        return None


def models(made: Any, tmp_path: Path, *, each: bool) -> Iterator[tuple[Place, Model]]:
    """Yield models with a hostile string at every place in turn, with each of the strings or with one."""
    content = full(made)
    places = [*strings(content), *KEYS]
    assert len(places) > 20
    for i, place in enumerate(places):
        for text in HOSTILE if each else (HOSTILE[i % len(HOSTILE)],):
            model = loaded(injected(content, place, text), tmp_path / "m.yaml")
            if model is not None:
                yield place, model


@pytest.fixture(scope="module")
def hostile_models(
    tmp_path_factory: pytest.TempPathFactory,
) -> Callable[[bool, bool], tuple[tuple[Place, Model], ...]]:
    folder = tmp_path_factory.mktemp("hostile")
    return cache(lambda commands, each: tuple(models(COMMAND if commands else WHEEL, folder, each=each)))


def code_of(target: Target, text: str) -> Any:
    """Return what the tool reads: C without its comments, the content of YAML."""
    if target.name == "c-header":
        assert "??" not in text
        return re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    if target.name in ("px4", "ardupilot"):
        return [line for line in text.splitlines() if line and not line.startswith("#")]
    return yaml.safe_load(text)


@pytest.mark.parametrize("each", [False, pytest.param(True, marks=pytest.mark.slow)])
@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_no_string_of_a_model_leaves_the_comments_of_an_export(
    target: Target, each: bool, hostile_models: Callable[[bool, bool], tuple[tuple[Place, Model], ...]]
) -> None:
    made = SOURCES[target.name]
    plain = export_model(make_model(made), target.name, name="m.yaml", options=VERSIONS)
    expected = code_of(target, plain.text)
    passed = set()
    for place, model in hostile_models(made.commands, each):
        passed.add(place[0])
        text = export_model(model, target.name, name="m.yaml", options=VERSIONS).text
        assert code_of(target, text) == expected, place
        assert all(c.isprintable() or c in "\n\t" for c in text), place
    assert {"provenance", "verdict"} <= passed  # free text is let in, and quoted
    for name in HOSTILE:  # of the model's file
        again = export_model(make_model(made), target.name, name=name, options=VERSIONS)
        assert code_of(target, again.text) == expected


def test_names_and_units_are_those_of_the_parameters(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for field in ["name", "unit"]:
        for text in HOSTILE:
            with subtests.test(field=field, text=text):
                content = full(WHEEL)
                content["parameters"][0][field] = text
                assert loaded(content, tmp_path / "m.yaml") is None


def test_a_wrong_unit_is_said_in_one_line(tmp_path: Path) -> None:
    content = full(WHEEL)
    content["parameters"][1]["unit"] = "deg/s per w"
    (tmp_path / "m.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
    with pytest.raises(ModelError, match=r"the unit of ang.w is rad/s per w, not 'deg/s per w' \(.*m.yaml\)"):
        load_model(tmp_path / "m.yaml")


def test_no_string_of_a_model_reaches_a_lattice(tmp_path: Path) -> None:
    content = full(WHEEL)
    for place in strings(full(WHEEL)):
        text = "".join(HOSTILE)
        if loaded(injected(content, place, text), tmp_path / "m.yaml") is not None:
            content = injected(content, place, text)
    hostile = loaded(content, tmp_path / "m.yaml")
    assert hostile is not None
    small = LatticeOptions(headings=8, turns=1, grid=0.2)
    made, expected = (
        json.loads(write_lattice(tmp_path / "l.json", model, options=small).read_text(encoding="utf-8"))
        for model in (hostile, make_model(WHEEL))
    )
    assert made == expected


class _Tags(HTMLParser):
    """Collects elements and their handlers, so that what a browser would run is seen."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, tuple[str, ...]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, tuple(name for name, _ in attrs)))


def elements(page: str) -> list[tuple[str, tuple[str, ...]]]:
    tags = _Tags()
    tags.feed(page)
    return tags.found


@pytest.fixture(scope="module")
def page_of() -> Callable[[str], str]:
    """Return the page of one plan under any title, which is made of the names of files."""
    free = GridMap(np.zeros((80, 80), dtype=np.bool_), 0.1, (-4.0, -4.0))
    start, goal = (-2.0, 0.0, 0.0), (2.0, 0.0, 0.0)
    route = RoutePlanner(make_model(WHEEL), free, search=RouteOptions(radius=0.3)).route(start, goal)
    return lambda title: plan_page(Plan(route, free, 0.3, start, goal, title))


def test_the_names_of_files_do_not_reach_the_markup_of_a_plan(
    page_of: Callable[[str], str], subtests: pytest.Subtests
) -> None:
    for text in HOSTILE:
        with subtests.test(text=text):
            assert elements(page_of(text)) == elements(page_of("model.yaml on map.yaml"))
