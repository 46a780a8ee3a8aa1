# SPDX-License-Identifier: Apache-2.0
"""A node that remembers surfaces: what it says of them, what it is told, and what it keeps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from sample_surfaces import FIRM, LOOSE, floor_log, model_of_floors
from scripted_node import Scripted

from slipwise.calibration import Settings
from slipwise.calibration.calibrate_sequence import calibrate_sequence
from slipwise.calibration.live_table import LiveTable
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.prepared_run import prepare_run
from slipwise.live.build import Built, build_node
from slipwise.live.outputs import SurfaceNow, surface_content
from slipwise.live.replay import Replay, samples_of
from slipwise.live.said import Said
from slipwise.live.samples import DriveStart, Sample, SurfaceCue
from slipwise.live.surface_watch import SurfaceWatch
from slipwise.logs import Log


def settings_for(**live: object) -> Settings:
    return Settings().model_copy(update={"live": LiveTable.model_validate({"memory": True} | live)})


def samples_on(slip: tuple[float, float], seed: int, *, later: float = 0.0) -> list[Sample]:
    """A minute on one floor, `later` [s] by its stamps."""
    (run,) = prepare_run(floor_log(slip, seed), "wheel")
    return [replace(sample, t=sample.t + later) for sample in samples_of(run)]


def run_remembering(script: list[Sample], **live: object) -> tuple[Built, Scripted, list[SurfaceNow]]:
    transport = Scripted(script)
    built = build_node(transport, "wheel", settings_for(**live), run="test")
    built.node.run()
    return built, transport, [output for output in transport.outputs if isinstance(output, SurfaceNow)]


def replayed(log: Log, **live: object) -> str:
    transport = Replay(log, "wheel", rate=0.0, label=live.get("surface"))  # type: ignore[arg-type]
    built = build_node(transport, "wheel", settings_for(**live))
    built.node.run()
    return built.learning.learner.judged_model(log=log)[0].to_yaml()


@pytest.fixture(scope="module")
def floors(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model file that remembers a hall and sand."""
    path = tmp_path_factory.mktemp("floors") / "floors.yaml"
    model_of_floors(FIRM, LOOSE, labels=("hall", "sand")).save(path)
    return path


def two_runs() -> Log:
    """A log of two runs, whose labels come at the start and change under way."""
    first, second = floor_log(FIRM, 5, terrain="hall").runs[0], floor_log(LOOSE, 6, terrain="sand").runs[0]
    labels = second.extra["terrain"].copy()
    labels[: len(labels) // 2] = "hall"
    late = replace(second, extra={"t": second.extra["t"], "terrain": labels})
    return Log(runs=(first, late))


def test_a_log_that_is_replayed_gives_the_model_of_calibrate_with_a_memory() -> None:
    log = two_runs()
    wanted = calibrate_sequence([log], input="wheel")[0].model
    assert replayed(log) == wanted.to_yaml()


def test_the_surface_is_said_with_its_probability_and_what_is_remembered(floors: Path) -> None:
    _, transport, said = run_remembering(samples_on(LOOSE, 8), model=str(floors))
    assert said[0].probability < 1.0
    assert said[-1].name == "sand"
    assert 0.98 < said[-1].probability < 1.0  # one that is like it competes still
    assert abs(sum(value for _, value in said[0].probabilities) - 1.0) < 1e-9
    assert [each.name for each in said[-1].remembered] == ["hall", "sand"]
    assert surface_content(said[-1])["surface"] == "sand"
    assert any(text.startswith("the surface is sand, as before") for text in transport.said)
    assert transport.statuses[-1].surface == said[-1]


def test_a_model_file_that_remembers_nothing_is_named(tmp_path: Path) -> None:
    from slipwise import calibrate

    plain = tmp_path / "plain.yaml"
    calibrate(floor_log(FIRM, 4), input="wheel").model.save(plain)
    built, _, _ = run_remembering([], model=str(plain))
    assert any("remembers no surfaces" in text for _, text in built.said.log())


def test_a_label_and_a_cue_under_way_reach_the_learner(floors: Path) -> None:
    script = [*samples_on(FIRM, 9), SurfaceCue("sand"), *samples_on(LOOSE, 10, later=60.0)]
    built, _, said = run_remembering(script, model=str(floors), surface="hall")
    assert said[-1].name == "sand"
    assert built.learning.learner.label_counts()[1] > 0.0
    script = [*samples_on(FIRM, 9), SurfaceCue(), *samples_on(LOOSE, 10, later=60.0)]
    built, _, said = run_remembering(script, model=str(floors))
    assert said[-1].name == "sand"
    assert built.said.counts["cues that the surface changes"] == 1


def test_after_a_restart_the_surfaces_are_known(tmp_path: Path) -> None:
    first, _, said = run_remembering(samples_on(FIRM, 11), cache=str(tmp_path), surface="hall")
    names = [each.name for each in first.learning.learner.surfaces()]
    assert names == ["hall"]
    again, transport, said = run_remembering(samples_on(FIRM, 12), cache=str(tmp_path))
    assert any("goes on from" in text for text in transport.said)
    assert said[-1].name == "hall"
    assert again.learning.learner.surfaces()[0].visits == 2
    assert [each.name for each in again.learning.learner.model().content.surfaces] == ["hall"]


def test_a_cache_without_a_memory_is_not_taken_for_one_with_it(tmp_path: Path) -> None:
    run_remembering(samples_on(FIRM, 11)[:200], cache=str(tmp_path), memory=False)
    _, transport, _ = run_remembering([], cache=str(tmp_path))
    assert any("the cache is of another set of settings" in text for text in transport.said)


class Told(MotionLearner):
    """Counts what it is told."""

    def __init__(self, *, remember: bool) -> None:
        super().__init__("wheel", remember=remember)
        self.told: list[str] = []

    def cue_surface(self, label: str = "") -> None:
        self.told.append(label)


def test_a_label_that_is_repeated_says_nothing_new() -> None:
    learner = Told(remember=True)
    watch = SurfaceWatch(learner, Said())
    watch.start_drive("a", DriveStart("sand", "2026-01-01"))
    for label in ("sand", " sand ", "gravel", "gravel", "", "gravel", "x" * 200, "x" * 300):
        watch.take(SurfaceCue(label), 1.0)
    assert learner.told == ["gravel", "", "gravel", "x" * 80]
    watch.start_run("b")
    watch.take(SurfaceCue("x" * 80), 2.0)
    assert learner.told[-1] == "x" * 80


def test_without_a_memory_labels_are_left_out_once_said_and_cues_still_speak() -> None:
    learner, said = Told(remember=False), Said()
    watch = SurfaceWatch(learner, said)
    watch.start_drive("a", DriveStart())
    for label in ("sand", "gravel", "", "  "):
        watch.take(SurfaceCue(label), 1.0)
    assert learner.told == [""]
    assert len(said.log()) == 1
    assert said.counts["a label without a name"] == 1
    assert watch.learned(1.0) is None
