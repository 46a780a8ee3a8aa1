# SPDX-License-Identifier: Apache-2.0
"""What was learned outlives the process, and nobody takes another robot's for it."""

from __future__ import annotations

from pathlib import Path

import pytest
from sample_logs import Drive, simulated_log
from sample_models import make_model, named

import slipwise as sw
from slipwise.calibration import Settings, make_settings
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.prepared_run import prepare_run
from slipwise.cli.live_parts import model_of_replay
from slipwise.errors import OutputError, SettingsError
from slipwise.live.build import build_node
from slipwise.live.cache import Cache, CacheKey
from slipwise.live.replay import Replay, samples_of
from slipwise.live.samples import Pose
from slipwise.logs import LogOptions

KEY = CacheKey.of("husky-1", "wheel", Settings())


@pytest.fixture(scope="module")
def learner() -> MotionLearner:
    learner = MotionLearner("wheel")
    learner.start_run("monday")
    (run,) = prepare_run(simulated_log(Drive(seconds=30.0)), "wheel")
    for sample in samples_of(run):
        if isinstance(sample, Pose):
            learner.push_pose(sample.t, sample.x, sample.y, sample.yaw)
        else:
            learner.push_wheels(sample.t, sample.v, sample.omega)
    return learner


def test_it_goes_on_from_where_it_was(tmp_path: Path, learner: MotionLearner) -> None:
    valid = make_model(named("edd-2"))
    Cache(tmp_path, KEY).save(learner, valid)
    found = Cache(tmp_path, KEY).load()
    assert found.learner is not None
    assert found.learner.model(limits=False).content == learner.model(limits=False).content
    assert found.valid is not None
    assert found.valid.content == valid.content
    assert "goes on" in found.said


def test_nothing_is_said_where_there_is_none(tmp_path: Path) -> None:
    found = Cache(tmp_path, KEY).load()
    assert found.learner is None
    assert found.said == ""


@pytest.mark.parametrize(
    ("other", "named_as"),
    [
        (CacheKey.of("husky-2", "wheel", Settings()), "vehicle"),
        (CacheKey.of("husky-1", "wheel", Settings(basis="edd-2")), "basis"),
        (CacheKey.of("husky-1", "wheel", Settings(learn_clock_offset=False)), "set of settings"),
        (CacheKey.of("husky-1", "wheel", Settings(), LogOptions(wheel_scale=(2.0, 1.0))), "set of settings"),
        (CacheKey.of("husky-1", "wheel", Settings(), LogOptions(vehicle="robotino")), "set of settings"),
    ],
)
def test_anothers_is_refused_and_kept(
    tmp_path: Path, learner: MotionLearner, other: CacheKey, named_as: str
) -> None:
    saved = Cache(tmp_path, other)
    saved.save(learner, None)
    mine = Cache(tmp_path, KEY)
    saved.state.rename(mine.state) if saved.state != mine.state else None
    found = mine.load()
    assert found.learner is None
    assert named_as in found.said
    assert mine.state.with_name(mine.state.name + ".set-aside").exists()
    assert not mine.state.exists()


@pytest.mark.parametrize("damage", ["cut", "empty", "noise"])
def test_what_cannot_be_read_is_set_aside_and_said(
    tmp_path: Path, learner: MotionLearner, damage: str
) -> None:
    cache = Cache(tmp_path, KEY)
    cache.save(learner, None)
    whole = cache.state.read_bytes()
    damaged = {"cut": whole[: len(whole) // 2], "empty": b"", "noise": whole[:100] + b"x" + whole[101:]}
    cache.state.write_bytes(damaged[damage])
    found = cache.load()
    assert found.learner is None
    assert "cannot be read" in found.said
    assert "set-aside" in found.said
    cache.close()
    assert Cache(tmp_path, KEY).load().said == ""


def test_a_second_node_on_the_same_cache_is_refused_until_the_first_ends(tmp_path: Path) -> None:
    first, second = Cache(tmp_path, KEY), Cache(tmp_path, KEY)
    first.load()
    with pytest.raises(OutputError, match=r"another node has this cache.*--name"):
        second.load()
    first.close()
    assert second.load().said == ""


def test_a_state_that_ended_two_starts_is_set_aside_at_the_third(
    tmp_path: Path, learner: MotionLearner
) -> None:
    Cache(tmp_path, KEY).save(learner, None)
    for _ in range(2):
        assert Cache(tmp_path, KEY).load().learner is not None  # and the process dies
    third = Cache(tmp_path, KEY)
    found = third.load()
    assert found.learner is None
    assert "ended the last 2 starts" in found.said
    assert third.state.with_name(third.state.name + ".set-aside").exists()
    third.save(learner, None)
    third.close()
    for _ in range(4):  # starts that end in order
        in_order = Cache(tmp_path, KEY)
        assert in_order.load().learner is not None
        in_order.close()


def test_a_state_that_cannot_be_judged_is_neither_saved_nor_used(
    tmp_path: Path, learner: MotionLearner, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache = Cache(tmp_path, KEY)
    cache.save(learner, None)
    before = cache.state.read_bytes()

    def judge(self: MotionLearner, **_: object) -> None:
        raise ZeroDivisionError("a fault of slipwise")

    monkeypatch.setattr(MotionLearner, "judged_model", judge)
    with pytest.raises(SettingsError, match="cannot be judged: a fault of slipwise"):
        cache.save(learner, None)
    assert cache.state.read_bytes() == before
    found = cache.load()
    assert found.learner is None
    assert "cannot be read: a fault of slipwise" in found.said


def test_settings_of_the_node_alone_are_no_other_robot() -> None:
    changed = Settings().model_copy(update={"live": Settings().live.model_copy(update={"name": "another"})})
    assert CacheKey.of("husky-1", "wheel", changed) == KEY


def test_a_log_that_is_replayed_again_is_said_and_counts_with_what_was_learned(tmp_path: Path) -> None:
    sw.save_log(simulated_log(Drive(seconds=90.0)), tmp_path / "drive.csv")
    log = sw.open_log(tmp_path / "drive.csv")
    settings = make_settings({"basis": "edd-2", "live": {"cache": str(tmp_path / "cache")}})
    models = []
    for _ in range(2):
        built = build_node(Replay(log, "wheel", rate=0.0), "wheel", settings)
        built.learning.learner.know_log(log)
        built.node.run()
        models.append(model_of_replay(built, log).content)
    first, second = models
    assert second.provenance.logs == first.provenance.logs
    assert second.provenance.learned_segments == 2 * first.provenance.learned_segments
    said = ("The learner has learned", "counts twice")
    assert all(words in second.verdict.sentence for words in said)
    assert not any(words in first.verdict.sentence for words in said)


def test_a_folder_that_cannot_be_written_is_an_error_that_says_so(
    tmp_path: Path, learner: MotionLearner
) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(OutputError, match="part of the path is a file"):
        Cache(tmp_path / "file", KEY).save(learner, None)


def test_a_vehicle_without_a_name_has_no_cache(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="--name"):
        Cache(tmp_path, CacheKey.of("///", "wheel", Settings())).load()
