# SPDX-License-Identifier: Apache-2.0
"""Uses in which the same measurements come another way: live, pushed by hand, converted."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from matrix import drives
from matrix.learned import Learned, verb
from matrix.simulator import Floats, Robot, held_commands, in_space, seen_from_start

import slipwise as sw
from slipwise.calibration.coming import coming_of
from slipwise.calibration.from_prior import KnownFleet, begin_from, start_of
from slipwise.calibration.prepared_run import has_wheels, prepare_run
from slipwise.live.replay import samples_of
from slipwise.live.samples import Command, KnownForce, Pose, Reading, Sample, Wheels
from slipwise.logs import Log
from slipwise.models import Model, load_model
from slipwise.segments import source_names


def same(model: Model, other: Model, within: float) -> None:
    """Hold two models to be one: the same parameters within some standard deviations, the same verdict."""
    names, others = model.table.names, other.table.names
    assert names == others, f"parameters are {others}, not {names}"
    far = [
        f"{row.name} is {abs(now - row.value) / row.std:.2g} standard deviations off"
        for row, now in zip(model.table.rows, other.table.values.tolist(), strict=True)
        if abs(now - row.value) > within * row.std
    ]
    assert not far, ", ".join(far)
    assert model.verdict.good == other.verdict.good, other.verdict.sentence


@contextmanager
def read_from(data: bytes) -> Iterator[None]:
    """Let standard input hold these bytes."""
    before = sys.stdin
    sys.stdin = SimpleNamespace(buffer=io.BytesIO(data))  # type: ignore[assignment]
    try:
        yield
    finally:
        sys.stdin = before


def replay(learned: Learned) -> None:
    """A live node that the log is replayed through learns the bytes of `calibrate`."""
    live = learned.folder / "live.yaml"
    learned.calibration  # noqa: B018 - learned once
    verb(
        *("live", "--replay", learned.log, "--rate", "0", "--quiet", "-o", live),
        *(*learned.live, *learned.common),
    )
    assert live.read_bytes() == learned.path.read_bytes()


def lines(learned: Learned) -> None:
    """The same log as lines on standard input teaches the same, and what is valid is published."""
    live, results = learned.folder / "lines.yaml", learned.folder / "results.jsonl"
    learned.calibration  # noqa: B018 - learned once
    with read_from(learned.log.read_bytes()):
        verb(
            *("live", "--transport", "stdin", "--results", results, "-o", live),
            *(*learned.live, *learned.common),
        )
    whole, streamed = learned.model, sw.load_model(live)
    same(*(model.with_table(model.table.without("mount")) for model in (whole, streamed)), 1e-6)
    same(whole, streamed, 2.0)  # mounts follow from whole tracks, of which a stream keeps parts
    published = [json.loads(line) for line in results.read_text(encoding="utf-8").splitlines()]
    models = [each["model"].splitlines()[0] for each in published if "model" in each]
    assert models, "no model was published"
    if learned.model.verdict.good:
        assert any("newest" in each or "valid" in each for each in models), models[-1]


@cache
def learner_of(learned: Learned) -> sw.MotionLearner:
    """Push all measurements of the log by hand, with the learner saved and loaded between."""
    log = sw.open_log(learned.log, options=learned.options)
    (run,) = prepare_run(log, learned.situation.learns)
    samples = list(samples_of(run, source_names((run.run,))))
    learner = learner_for(learned, log)
    if learned.situation.before is not None:
        learner.begin_with(load_model(learned.begins[1]), wheels=True)
        learner.start_drive(
            run.run.name, label=str(run.run.extra["terrain"][0]) if "terrain" in run.run.extra else ""
        )
    else:
        if learned.situation.fleet:
            start = start_of(KnownFleet.load(Path(learned.begins[1])))
            begin_from(learner._core, start, learned.situation.learns, wheels=has_wheels((run,)))
        learner.start_run(run.run.name)
    for k, sample in enumerate(samples):
        push(learner, sample)
        if k == len(samples) // 2:
            learner = sw.MotionLearner.load(learner.save())
    learner.know_log(log)
    return learner


def pushed(learned: Learned) -> None:
    """Measurements that are pushed by hand, with the learner saved and loaded between, teach the same."""
    log = sw.open_log(learned.log, options=learned.options)
    same(learned.model, learner_of(learned).judged_model(log=log)[0], 1e-9)


def ahead(learned: Learned) -> None:
    """What a learner predicts from its last measurement on is where the true robot goes from there."""
    situation = learned.situation
    told = held_commands(situation.ranges, situation.seconds, 1)
    before = np.column_stack((np.arange(len(told)) * 0.05, told))
    more = situation.manoeuvre
    more[:, 0] += situation.seconds
    learner = learner_of(learned)
    learner.model()  # which finds the limits of the drive
    pushes = held_force(situation.robot, situation.seconds, drives.SECONDS)
    path = learner.predict(situation.rows(more), horizon=drives.SECONDS, forces=pushes)
    driven = situation.driven(np.vstack((before, more)), situation.seconds + drives.SECONDS)
    through = driven.pose[driven.at(np.array([path.start, path.start + drives.SECONDS]))]
    truth = seen_from_start(in_space(situation.robot, through)[:, [0, 1, 5]])[-1]
    drives.close(learned, path.poses[-1], truth, share=2.5)  # it starts at the speed that the log ends with


def held_force(robot: Robot, since: float, seconds: float) -> Floats:
    """Return the known force over a time ahead as rows of a stamp and its two parts."""
    amplitude, period = robot.force
    t = since + np.arange(0.05, seconds if amplitude else 0.0, 0.1)
    return np.column_stack((t, np.zeros(len(t)), amplitude * np.cos(2.0 * np.pi * t / period)))


def learner_for(learned: Learned, log: Log) -> sw.MotionLearner:
    """Return a learner that is told what will come."""
    return sw.MotionLearner(
        learned.situation.learns,
        learned.chosen,
        coming=coming_of(log),
        remember=learned.situation.before is not None,
    )


def push(learner: sw.MotionLearner, sample: Sample) -> None:
    """Push one sample as a robot's program would."""
    if isinstance(sample, Command):
        learner.push_command(sample.t, sample.v, sample.omega, sample.vy)
    elif isinstance(sample, Wheels):
        learner.push_wheels(sample.t, sample.v, sample.omega, sample.vy)
    elif isinstance(sample, KnownForce):
        learner.push_force(sample.t, sample.x, sample.y)
    elif isinstance(sample, Reading):
        learner.push_reading(sample.t, sample.column, sample.value)
    elif isinstance(sample, Pose):
        if sample.roll is not None and sample.pitch is not None:
            learner.push_attitude(sample.t, sample.roll, sample.pitch)
        kept = {"frame": int(sample.frame or 0), "source": sample.source, "fix": sample.fix}
        if np.isnan(sample.yaw):
            learner.push_position(sample.t, sample.x, sample.y, sample.std_xy, **kept)
        else:
            learner.push_pose(sample.t, sample.x, sample.y, sample.yaw, sample.std_xy, sample.std_yaw, **kept)


def samples(learned: Learned, log: Log) -> list[Sample]:
    """Return all that is learned from a log, in the order of time."""
    runs = prepare_run(log, learned.situation.learns)
    return [sample for run in runs for sample in samples_of(run)]


def converted(learned: Learned, ending: str, within: float) -> None:
    """Convert the log, and hold each sample that is learned from to be the same."""
    path = learned.folder / f"converted.{ending}"
    verb("convert", learned.log, "-o", path, *learned.reading)
    before, after = (
        samples(learned, sw.open_log(each, options=learned.options)) for each in (learned.log, path)
    )
    assert [type(sample) for sample in before] == [type(sample) for sample in after]
    far = [
        f"{field.name} of {one} is {getattr(other, field.name)}"
        for one, other in zip(before, after, strict=True)
        for field in fields(one)
        if not alike(getattr(one, field.name), getattr(other, field.name), within)
    ]
    assert not far, f"{len(far)} numbers differ, the first: {far[0]}"


def alike(one: object, other: object, within: float) -> bool:
    """Return whether two entries of samples are the same, numbers within a bound."""
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= within or (np.isnan(one) and np.isnan(other))
    return one == other


def parquet(learned: Learned) -> None:
    """The log as Parquet has the same samples."""
    converted(learned, "parquet", 1e-9)


def mcap(learned: Learned) -> None:
    """The log as MCAP has the same samples, but for stamps in ns."""
    converted(learned, "mcap", 1e-6)


def several_logs(learned: Learned) -> None:
    """A log without the input that is learned from is said to be left out, and provenance omits it."""
    situation = learned.situation
    other = "odo_v,odo_omega" if situation.learns == "command" else "cmd_v,cmd_omega"
    lacking = learned.folder / "lacking.csv"
    rows = "".join(f"{0.1 * k:.1f},0.5,0.0,{0.05 * k:.3f},0.0,0.0\n" for k in range(600))
    lacking.write_text(f"t,{other},x,y,yaw\n{rows}", encoding="utf-8")
    said = learned.calibrated(learned.log, "with-lacking", lacking, "--no-report")
    document = json.dumps([said.document["notes"], said.document["left_out"]])
    assert "lacking" in document, "nothing says that a log was left out"
    model = sw.load_model(learned.folder / "with-lacking.yaml")
    assert [each.path for each in model.content.provenance.logs] == [str(learned.log)]
