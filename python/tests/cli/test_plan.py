# SPDX-License-Identifier: Apache-2.0
"""`slipwise plan` draws a route, and says in one line what stands in its way."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Result
from planning.planning_samples import learned_model, walled_map
from sample_models import Made, make_model

from slipwise import _core
from slipwise.logs import open_log
from slipwise.planning.pgm import write_pgm

Slipwise = Callable[..., Result]
START, GOAL = "1.5,6,0", "5,6.4,0.1"


@pytest.fixture
def arguments(folder: Path) -> list[object]:
    """Write a model and a map; return how they are named."""
    learned_model().save(folder / "model.yaml")
    write_pgm(folder / "map.pgm", np.flipud(np.where(walled_map().occupied, 0.0, 1.0)))
    (folder / "map.yaml").write_text("image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n", encoding="utf-8")
    return ["plan", "--model", "model.yaml", "--map", "map.yaml", "--radius", "0.3"]


def test_plan_draws_the_swept_path_and_writes_the_commands(
    slipwise: Slipwise, arguments: list[object]
) -> None:
    result = slipwise(*arguments, "--from", START, "--to", GOAL, "-o", "out/dock")
    assert (result.code, result.err) == (0, "")
    assert "swept by the robot" in Path("out/dock.html").read_text(encoding="utf-8")
    table = np.genfromtxt("out/dock.csv", delimiter=",", names=True)
    assert table.dtype.names == ("t", "cmd_v", "cmd_omega")
    assert table["cmd_v"][-1] == 0.0
    assert "The predicted end is" in result.out


def test_the_commands_of_a_robot_that_drives_sideways_are_a_tidy_table(
    slipwise: Slipwise, folder: Path, arguments: list[object]
) -> None:
    make_model(Made(_core.named_basis("omni-8"), commands=True)).save(folder / "model.yaml")
    result = slipwise(*arguments, "--from", START, "--to", GOAL, "--json", "-")
    assert result.code == 0
    assert "to the left [m/s]" in Path("plan.html").read_text(encoding="utf-8")
    assert Path("plan.csv").read_text(encoding="utf-8").startswith("t,cmd_v,cmd_vy,cmd_omega\n")
    (folder / "poses.txt").write_text("0 0 0 0 0 0 0 1\n1 0.1 0 0 0 0 0 1\n", encoding="utf-8")
    read = open_log("plan.csv", poses=Path("poses.txt")).runs[0].commands
    assert read is not None
    assert read.rows() == pytest.approx(np.array(result.json["commands"]), abs=1e-6)


def test_a_bad_verdict_is_refused_unless_forced(
    slipwise: Slipwise, folder: Path, arguments: list[object]
) -> None:
    bad = make_model(Made(_core.named_basis("edd-2"), commands=True, good=False, sentence="It guesses."))
    bad.save(folder / "model.yaml")
    result = slipwise(*arguments, "--from", START, "--to", GOAL)
    assert (result.code, list(folder.glob("plan.*"))) == (1, [])
    assert "NOT GOOD ENOUGH. It guesses." in result.out
    assert slipwise(*arguments, "--from", START, "--to", GOAL, "--force").code == 0


def test_plan_tells_machines(slipwise: Slipwise, arguments: list[object]) -> None:
    result = slipwise(*arguments, "--from", START, "--to", GOAL, "--json", "-")
    assert result.code == 0
    assert result.json["end"] == pytest.approx([5.0, 6.4, 0.1], abs=5e-3)
    assert result.json["legs"] == 1


def test_a_plan_on_a_grade_takes_slope_and_direction(slipwise: Slipwise, arguments: list[object]) -> None:
    route = [*arguments, "--from", START, "--to", GOAL, "--json", "-"]
    level, tilted = slipwise(*route), slipwise(*route, "--grade", "15,180")
    assert (level.code, tilted.code) == (0, 0)
    assert tilted.json["end"] == pytest.approx([5.0, 6.4, 0.1], abs=5e-3)
    # A way up a slope is longer than it looks from above.
    assert tilted.json["duration"] > 1.01 * level.json["duration"]
    assert slipwise(*route, "--grade", "15").line.startswith("'15' is not a grade (--grade)")


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        ("5.7,2,0", GOAL, "the start lies in or too near an obstacle"),
        ("1,2", GOAL, "'1,2' is not a pose (--from): give X,Y,YAW"),
        (START, "nan,2,0", "'nan,2,0' is not a pose (--to)"),
        (
            "1.5,6,45",
            GOAL,
            "a heading of 45 rad is more than a turn (--from): give radians: 45 degrees are 0.7854",
        ),
        (START, "5,6.4,-6.3", "a heading of -6.3 rad is more than a turn (--to)"),
        (START, "40,2,0", "off the map"),
    ],
)
def test_a_pose_that_cannot_be_is_refused(
    slipwise: Slipwise, arguments: list[object], start: str, goal: str, message: str
) -> None:
    result = slipwise(*arguments, "--from", start, "--to", goal)
    assert result.code == 2
    assert message in result.line
    assert not Path("plan.html").exists()


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (
            ("--seed", "-1"),
            "a search with seed -1 and 1500 attempts cannot begin (seed): give a seed of 0 or more",
        ),
        (("--cruise", "1e-300"), "the cruise speed must be 0.001 m/s at least"),
        (("--cruise", "-1"), "the cruise speed must be 0.001 m/s at least"),
        (("--longest", "1e300"), "the longest path must lie between 0.01 and 10000 m"),
    ],
)
def test_options_that_make_no_sense_are_refused_with_advice(
    slipwise: Slipwise, arguments: list[object], option: tuple[str, str], message: str
) -> None:
    result = slipwise(*arguments, "--from", START, "--to", GOAL, *option)
    assert result.code == 2
    assert message in result.line


def test_a_route_over_the_edge_of_the_map_is_refused(slipwise: Slipwise, arguments: list[object]) -> None:
    write_pgm(Path("map.pgm"), np.ones((80, 120)))
    result = slipwise(*arguments, "--radius", "2", "--from", "0.05,0.05,0", "--to", "8,0.05,0")
    assert result.code == 2
    assert "the start lies in or too near an obstacle, or off the map" in result.line


def test_a_model_of_another_schema_version_is_refused(slipwise: Slipwise, arguments: list[object]) -> None:
    text = Path("model.yaml").read_text(encoding="utf-8").replace("slipwise_model: 5", "slipwise_model: 9")
    Path("model.yaml").write_text(text, encoding="utf-8")
    result = slipwise(*arguments, "--from", START, "--to", GOAL)
    assert result.code == 2
    assert "schema version 9" in result.line
