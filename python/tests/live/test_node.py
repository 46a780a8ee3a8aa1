# SPDX-License-Identifier: Apache-2.0
"""What the loop gives to others, and when."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest
from sample_cars import write_car_log
from sample_models import make_model, named
from sample_slopes import Hills, hilly_log
from scripted_node import SLIP, Scripted, driven, run_node

import slipwise as sw
from slipwise.calibration import Settings, make_settings
from slipwise.calibration.judgement import Judgement
from slipwise.calibration.live_table import LiveTable
from slipwise.calibration.prepared_run import prepare_run
from slipwise.errors import SettingsError
from slipwise.live.build import build_node
from slipwise.live.outputs import ModelText, Output, Validity
from slipwise.live.replay import samples_of
from slipwise.live.samples import Answer, Pose, Request
from slipwise.live.validity import judged
from slipwise.logs import LogOptions
from slipwise.models import Model


def models(outputs: list[Output]) -> list[tuple[str, str]]:
    """Which model was published each time, and the model."""
    texts = [output.text.split("\n", 1) for output in outputs if isinstance(output, ModelText)]
    return [(head.split("s: ", 1)[1], body) for head, body in texts]


def test_the_start_model_is_published_once_however_often_nothing_valid_is_found(tmp_path: Path) -> None:
    start = tmp_path / "start.yaml"
    make_model(named("edd-2")).save(start)
    no_slip = replace(SLIP, seconds=60.0, alpha=(0.0, 0.0), lag=0.0, delay=0.0)
    built, transport = run_node(driven(no_slip), LiveTable(model=str(start)), basis="auto")
    assert built.learning.segments > 20
    assert [which for which, _ in models(transport.outputs)] == [
        "the start model; the learned one is not yet valid"
    ]


def test_the_last_valid_model_is_published_once_while_nothing_newer_is_valid(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    judgements = []

    def soon_invalid(model: Model, judgement: Judgement) -> tuple[Validity, str]:
        judgements.append(judgement)
        found = judged(model, judgement)
        return found if len(judgements) < 20 else ("invalid", "its errors have become larger")

    monkeypatch.setattr("slipwise.live.validity.judged", soon_invalid)
    _, transport = run_node(driven())
    assert len(judgements) > 25
    published = models(transport.outputs)
    assert published[0][0] == "valid"
    assert published[-1][0] == "the last valid one; the model is not valid now"
    assert [which for which, _ in published].count(published[-1][0]) == 1
    assert published[-1][1] == published[-2][1]
    assert all(before != after for before, after in itertools.pairwise(published))
    assert transport.statuses[-1].given == "the last valid one; the model is not valid now"


def test_the_column_at_start_holds_start_values_where_nothing_is_handed_on() -> None:
    _, transport = run_node(driven())
    rows = transport.statuses[-1].parameters
    slip = [row for row in rows if row.name.partition(".")[0] in {"lon", "lat", "ang"}]
    assert slip
    assert all(row.start == 0.0 for row in slip)
    assert any(abs(row.value) > 3.0 * row.std for row in slip)
    assert all(row.applied is None for row in rows)


@pytest.mark.parametrize("attitude", [False, True])
def test_terms_of_gravity_are_tried_where_poses_are_said_to_have_an_attitude(attitude: bool) -> None:
    (run,) = prepare_run(hilly_log(1, Hills(seconds=60.0)), "command")
    built, transport = run_node(list(samples_of(run)), LiveTable(attitude=attitude), "command", "auto")
    model = built.learning.learner.model(limits=False)
    assert any(".gy" in name for name in model.parameters) == attitude
    said = [text for text in transport.said if "terms of gravity are not tried" in text]
    assert len(said) == (0 if attitude else 1)


class Compared(Scripted):
    """Knows when each sample arrived."""

    @property
    def clocks_compared(self) -> bool:
        return True


@pytest.mark.parametrize("transport", [Scripted, Compared])
def test_a_delay_of_seconds_is_real_where_stamps_were_compared_with_arrival(
    transport: type[Scripted],
) -> None:
    delivers = transport(driven(replace(SLIP, delay=1.5), "command"))
    built = build_node(delivers, "command", make_settings({"basis": "edd-2"}), run="test")
    built.node.run()
    assert built.learning.model is not None
    verdict = built.learning.model.content.verdict
    assert verdict.good is (transport is Compared)
    assert ("their clocks differ" in verdict.sentence) is (transport is Scripted)


def test_a_node_goes_on_with_what_another_has_learned_or_forgets_it(tmp_path: Path) -> None:
    table = LiveTable(cache=str(tmp_path))
    built, _ = run_node(driven(), table)
    settings = Settings(basis="edd-2").model_copy(update={"live": table})
    goes_on = build_node(Scripted([]), "wheel", settings, run="again", kept=built.learning)
    assert goes_on.learning.learner is built.learning.learner
    goes_on.node.run()
    forgets = build_node(Scripted([]), "wheel", settings, run="again", forget=True)
    assert not forgets.learning.learner.learned
    assert [path.suffix for path in tmp_path.glob("*.state*")] == [".set-aside"]
    forgets.node.run()


def test_requests_are_answered_in_turn(tmp_path: Path) -> None:
    answers: dict[str, Answer] = {}

    def ask(name: str, kind: Literal["predict", "freeze", "resume", "save"], content: str = "") -> Request:
        return Request(kind, content, lambda answer: answers.update({name: answer}))

    first, rest = driven()[:2000], driven()[2000:]
    numbers = {"t": [0.0, 1.0], "v": [1.0, 1.0], "omega": [0.0, 0.5]}
    script = [
        ask("too early", "predict", '{"commands": []}'),
        *first,
        ask("ahead", "predict", json.dumps({"horizon": 2.0, "ahead": numbers})),
        ask("unknown", "predict", json.dumps({"ahead": numbers | {"vy": [0.1, 0.1]}})),
        ask("short", "predict", json.dumps({"ahead": numbers | {"v": [1.0]}})),
        ask("freeze", "freeze"),
        *rest,
        ask("save", "save"),
    ]
    built, _ = run_node(script, LiveTable(cache=str(tmp_path)))
    assert {name for name, answer in answers.items() if answer.success} == {"ahead", "freeze", "save"}
    assert answers["too early"].message.endswith("no pose was measured yet")
    assert answers["unknown"].message.endswith("the robot takes v, omega, not vy")
    assert answers["short"].message.endswith("give as many numbers of v, omega as of t")
    path = answers["ahead"].path
    assert path is not None
    assert path.t[-1] - path.t[0] == pytest.approx(2.0)
    counted = built.said.counts["poses not learned from: it was asked to rest"]
    assert counted == sum(isinstance(sample, Pose) for sample in rest)


@pytest.mark.slow
def test_a_start_model_of_throttle_and_steering_is_refused_by_a_robot_of_speeds(tmp_path: Path) -> None:
    log = sw.open_log(write_car_log(tmp_path / "car.csv", 60.0), options=LogOptions(vehicle="dart"))
    sw.calibrate(log).model.save(tmp_path / "car.yaml")
    start = LiveTable(model=str(tmp_path / "car.yaml"))
    with pytest.raises(SettingsError, match="takes throttle and steering, this robot is sent speeds"):
        run_node(driven(), start, "command")
    make_model(replace(named("edd-2"), commands=True)).save(tmp_path / "rover.yaml")
    car = LiveTable(model=str(tmp_path / "rover.yaml"), vehicle="dart")
    with pytest.raises(SettingsError, match="takes speeds and yaw rates, this robot is sent throttle"):
        run_node(driven(), car, "command", "auto")
