# SPDX-License-Identifier: Apache-2.0
"""Reads ROS bags: rosbag1, rosbag2 (sqlite3 or MCAP), one file or a folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.bag_file import BagFile, bag_files, files_sha256
from slipwise.logs.bag_parts import Collected, parts_of
from slipwise.logs.bag_streams import (
    BagContext,
    command_stream,
    fix_stream,
    force_stream,
    gyro_stream,
    pose_stream,
    wheel_stream,
    with_tilts,
)
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.topics import MissingFile
from slipwise.logs.foxglove_file import open_bag
from slipwise.logs.gyro import with_gyro
from slipwise.logs.joints import SideMotion, sides_text
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Inputs, Ints, Log, Run, Source, empty_poses, run_name
from slipwise.logs.messages import (
    COMMAND_VALUES,
    FORCE_VALUES,
    GYRO_VALUES,
    IMU_VALUES,
    JOINT_STATE,
    NAV_SAT_FIX,
    POSE_VALUES,
    TF,
    TWIST,
    WHEEL_VALUES,
    WRONG_CONTENT,
    SampleCollector,
    Samples,
    time_of,
)
from slipwise.logs.options import LogOptions
from slipwise.logs.role_choice import Topic
from slipwise.logs.streams import RawStream, to_forces, to_inputs, to_poses
from slipwise.logs.topics import Roles, choose_topics, transforms_matter
from slipwise.logs.transforms import (
    TransformCollector,
    TransformSource,
    chain_poses,
    choose_frames,
    describe_transforms,
    known_edges,
)
from slipwise.logs.wheel_readings import JointReadings

RUN_TOPIC = "/slipwise/run"  # std_msgs/String: a new run of this name starts here
RUN_TYPE = "std_msgs/msg/String"
FORCE_TOPIC = "/slipwise/force"  # a known force over the mass along the robot's axes, until the next
CLOCK_TOPIC = "/clock"
CLOCK_TYPE = "rosgraph_msgs/msg/Clock"

_OTHER = "pose of "  # begins the role of a further source of poses, before its topic

Consumer = Callable[[Any, int], None]


def read_bag(path: Path, options: LogOptions) -> Log:
    """Read one bag: a storage file, or the folder of a rosbag2.

    Args:
        path: the bag.
        options: topics, frames and sizes that cannot be guessed.

    Raises:
        LogError: the bag cannot be read, or its topics do not say which is which.
    """
    tally = Tally()
    files = bag_files(path)
    with open_bag(path, files, tally) as bag:
        try:
            transforms = collect_transforms(bag, options)
            source = transform_source(bag, transforms, options)
            roles = choose_topics(bag.topics, options, source)
            collected = _collect(bag, roles, transforms, options)
            advice = {role: _with_joints(bag, text, options) for role, text in roles.advice.items()}
            missing = map(MissingFile.of, bag.missing)
            notes: list[str | Finding] = [*roles.guessed, *advice.values(), *missing]
            context = BagContext(path.name, options, tally, notes)
            runs, compared = _runs_of_parts(path, roles, collected, context, file_missing=bool(bag.missing))
        except LogError as error:
            raise _told_of_bag(error, path, bag.topics, tally) from error
        count = sum(topic.count for topic in bag.topics)
        file = Source(str(path), files_sha256(files), bag.format, count)
    said = tuple(dict.fromkeys(map(str, notes)))
    found = tuple(dict.fromkeys(note for note in notes if isinstance(note, Finding)))
    return Log(runs, (file,), tally.result(), said, advice, compared, found=found)


def collect_transforms(bag: BagFile, options: LogOptions) -> TransformCollector:
    """Read all transforms of a bag where the choice of the pose depends on them."""
    transforms = TransformCollector()
    if not transforms_matter(bag.topics, options):
        return transforms
    names = {topic.name for topic in bag.topics if topic.type == TF}
    for message in bag.messages(names):
        decoded = bag.decode(message)
        if decoded is not None:
            static = message.topic.endswith("static")
            try:
                transforms.add(decoded, message.received_ns, static=static)
            except WRONG_CONTENT as error:
                bag.count_bad(message, error)
    return transforms


def transform_source(
    bag: BagFile, transforms: TransformCollector, options: LogOptions
) -> TransformSource | None:
    """Say what the transforms know of the robot; None where they were not read."""
    edges = transforms.edges()
    if not edges:
        return None
    name = next((t.name for t in bag.topics if t.type == TF and not t.name.endswith("static")), "TF")
    return describe_transforms(name, edges, options.pose_frame, options.child_frame)


def _with_joints(bag: BagFile, advice: str, options: LogOptions) -> str:
    """Add to the advice which joints of the first joint state look like wheels."""
    topics = {topic.name for topic in bag.topics if topic.type == JOINT_STATE}
    first = next((state for message in bag.messages(topics) if (state := bag.decode(message))), None)
    return (
        advice
        if first is None
        else f"{advice} ({sides_text(tuple(map(str, getattr(first, 'name', ()))), options)})"
    )


def _told_of_bag(error: LogError, path: Path, topics: Sequence[Topic], tally: Tally) -> LogError:
    """Name the bag in the error; where nothing of a damaged bag is left, the damage is the error."""
    damaged = any(item.kind == "damaged-bag" for item in tally.result())
    if damaged and not any(topic.count for topic in topics):
        return LogError("the bag is cut off: no message is left", where=str(path), advice="copy it again")
    return error if error.where else LogError(error.what, where=str(path), advice=error.advice)


def _collect(bag: BagFile, roles: Roles, transforms: TransformCollector, options: LogOptions) -> Collected:
    """Decode the messages of the chosen topics, each once."""
    consumers: dict[str, list[Consumer]] = {}
    collectors: dict[str, SampleCollector] = {}
    starts: list[tuple[int, str]] = []
    found = _extractors(roles, options)
    pushes = (topic for topic in bag.topics if topic.name == FORCE_TOPIC and topic.type in FORCE_VALUES)
    found += [("force", topic, FORCE_VALUES[topic.type]) for topic in pushes]
    for role, topic, values in found:
        collector = SampleCollector(topic.name, values, has_header=topic.type != TWIST)
        collectors[role] = collector
        consumers.setdefault(topic.name, []).append(collector.add)
    if any(topic.name == RUN_TOPIC and topic.type == RUN_TYPE for topic in bag.topics):
        consumers[RUN_TOPIC] = [lambda message, received_ns: starts.append((received_ns, str(message.data)))]
    ticks: list[tuple[int, int]] = []
    if any(topic.name == CLOCK_TOPIC and topic.type == CLOCK_TYPE for topic in bag.topics):
        consumers[CLOCK_TOPIC] = [
            lambda message, received_ns: ticks.append((received_ns, time_of(message.clock)))
        ]
    for message in bag.messages(set(consumers)):
        decoded = bag.decode(message)
        if decoded is None:
            continue
        for consume in consumers[message.topic]:
            try:
                consume(decoded, message.received_ns)
            except WRONG_CONTENT as error:
                bag.count_bad(message, error)
    for _, _, values in found:
        if isinstance(values, SideMotion | JointReadings):
            values.refuse_none()
    return Collected(
        {role: collector.result() for role, collector in collectors.items()},
        transforms,
        tuple(sorted(starts)),
        (np.array(ticks, dtype=np.int64)[:, 0], np.array(ticks, dtype=np.int64)[:, 1]) if ticks else None,
    )


def _extractors(
    roles: Roles, options: LogOptions
) -> list[tuple[str, Topic, Callable[[Any], tuple[float, ...]]]]:
    found: list[tuple[str, Topic, Callable[[Any], tuple[float, ...]]]] = []
    if roles.command is not None:
        found.append(("command", roles.command, COMMAND_VALUES[roles.command.type]))
    if roles.wheel is not None:
        joints = roles.wheel.type == JOINT_STATE
        found.append(
            ("wheel", roles.wheel, joint_values(options) if joints else WHEEL_VALUES[roles.wheel.type])
        )
    if roles.pose is not None and roles.pose.type != TF:
        found.append(("pose", roles.pose, POSE_VALUES[roles.pose.type]))
    found += [(f"{_OTHER}{topic.name}", topic, POSE_VALUES[topic.type]) for topic in roles.others]
    if roles.gyro is not None:
        found.append(("gyro", roles.gyro, GYRO_VALUES[roles.gyro.type]))
    if roles.imu is not None:
        found.append(("imu", roles.imu, IMU_VALUES[roles.imu.type]))
    return found


def joint_values(options: LogOptions) -> Callable[[Any], tuple[float, ...]]:
    """Return what takes wheels out of joint states: each that the vehicle names, or the sides."""
    return SideMotion(options) if options.wheels is None else JointReadings(options.wheels)


def _runs_of_parts(
    path: Path, roles: Roles, collected: Collected, context: BagContext, *, file_missing: bool
) -> tuple[tuple[Run, ...], bool]:
    """Make runs of each part of the bag; a clock that was set back or a missing file begins another.

    Returns:
        the runs, and whether header stamps could be compared with the times of receipt.
    """
    if roles.pose is not None and roles.pose.type != TF and len(collected.samples["pose"].values) == 0:
        raise LogError(f"no pose could be read from {roles.pose.name}", advice="give --pose-topic")
    parts, begins = parts_of(collected, file_missing=file_missing)
    context.notes.extend(begins)
    runs, compared = list[Run](), True
    for number, part in enumerate(parts, start=1):
        found, comparable = _runs(path, roles, part, context)
        compared = compared and comparable
        runs += found if number == 1 else [replace(run, name=f"{run.name}, part {number}") for run in found]
    return tuple(run for run in runs if len(parts) == 1 or len(run.poses)), compared


def _runs(
    path: Path, roles: Roles, collected: Collected, context: BagContext
) -> tuple[tuple[Run, ...], bool]:
    samples, notes = dict(collected.samples), context.notes
    if roles.pose is not None and roles.pose.type == TF:
        samples["pose"] = _transform_samples(roles.pose, collected.transforms, context)
    clocks = replace(collected, samples=samples).compared_clocks(roles.pose.name if roles.pose else None)
    context = replace(context, clocks=clocks)
    unstamped = [each.topic for each in samples.values() if not each.has_header and len(each.values)]
    notes.extend(clocks.said(unstamped))
    commands = wheels = poses = None
    if roles.command is not None and len(samples["command"].values):
        commands = command_stream(context, samples["command"], roles.command.type)
    if roles.wheel is not None and len(samples["wheel"].values):
        wheels = wheel_stream(context, samples["wheel"], roles.wheel.type)
    inputs = next((to_inputs(stream, Tally()) for stream in (wheels, commands) if stream is not None), None)
    if roles.pose is not None and roles.pose.type == NAV_SAT_FIX and len(samples["pose"].values):
        poses = fix_stream(context, samples["pose"], samples.get("imu"), inputs)
    elif roles.pose is not None and len(samples["pose"].values):
        poses = with_tilts(context, pose_stream(context, samples["pose"], inputs), samples.get("imu"))
    others = _other_streams(roles, samples, context, inputs)
    runs = _split(path, collected, (commands, wheels, poses), context.tally)
    if roles.gyro is not None and (poses is None or poses.course):
        runs = with_gyro(runs, gyro_stream(context, samples["gyro"]), collected.starts)
    runs = _with_others(runs, collected, others, roles, context.tally) if others else runs
    if "force" in samples and len(samples["force"].values):
        runs = _with_forces(runs, force_stream(context, samples["force"]), collected, context.tally)
    return runs, clocks.compared


def _other_streams(
    roles: Roles, samples: dict[str, Samples], context: BagContext, inputs: Inputs | None
) -> dict[str, RawStream]:
    """Return what further sources measured, by their topics; satellite fixes as positions."""
    found = {}
    for topic in roles.others:
        own = samples[f"{_OTHER}{topic.name}"]
        if topic.type == NAV_SAT_FIX:
            found[topic.name] = fix_stream(context, own, None, inputs)
        else:
            found[topic.name] = pose_stream(context, own)
    return found


def _with_others(
    runs: tuple[Run, ...],
    collected: Collected,
    others: dict[str, RawStream],
    roles: Roles,
    tally: Tally,
) -> tuple[Run, ...]:
    """Give each run what further sources measured in it, in the order of stamps."""
    first = "" if roles.pose is None else roles.pose.name
    found = []
    for number, run in enumerate(runs):
        beside = {}
        for name, stream in others.items():
            beside[name] = to_poses(stream.in_time(stream.in_run(number, collected.starts)), tally)
        found.append(replace(run, others=beside, source=first))
    return tuple(found)


def _with_forces(
    runs: tuple[Run, ...], stream: RawStream, collected: Collected, tally: Tally
) -> tuple[Run, ...]:
    """Give each run the known forces that came in it."""
    own = (stream.select(stream.in_run(number, collected.starts)) for number in range(len(runs)))
    return tuple(replace(run, forces=to_forces(each, tally)) for run, each in zip(runs, own, strict=True))


def _split(
    path: Path,
    collected: Collected,
    streams: tuple[RawStream | None, RawStream | None, RawStream | None],
    tally: Tally,
) -> tuple[Run, ...]:
    """Cut the streams into runs where the bag says so; otherwise a bag is one run."""
    names = [name for _, name in collected.runs] or [run_name(path)]
    runs = []
    for number, name in enumerate(names):
        commands, wheels, poses = (
            stream and stream.select(stream.in_run(number, collected.starts)) for stream in streams
        )
        runs.append(
            Run(
                name=name,
                commands=to_inputs(commands, tally) if commands else None,
                wheels=to_inputs(wheels, tally) if wheels else None,
                poses=to_poses(poses, tally) if poses else empty_poses(),
            )
        )
    return tuple(runs)


def _transform_samples(pose: Topic, transforms: TransformCollector, context: BagContext) -> Samples:
    edges, options = transforms.edges(), context.options
    frames = choose_frames(edges, options.pose_frame, options.child_frame)
    if frames is None:
        advice = f"give --pose-frame and --child-frame; it has {known_edges(edges)}"
        raise LogError("no usual frames in TF", advice=advice)
    found = chain_poses(edges, *frames)
    context.notes.append(f"poses are the transform {frames[0]} -> {frames[1]}")
    context.notes.extend(found.notes)
    frame: Ints = np.zeros(len(found.stamps), np.int64)
    return Samples(pose.name, found.stamps, found.received, found.values, ("",), frame, has_header=True)
