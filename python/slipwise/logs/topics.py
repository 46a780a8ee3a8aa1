# SPDX-License-Identifier: Apache-2.0
"""Guesses which topic of a bag is the command, the measured pose and the wheel odometry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from slipwise.errors import LogError
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.topics import OtherRobot, SilentTopic
from slipwise.logs.messages import (
    COMMAND_TYPES,
    IMU,
    JOINT_STATE,
    NAV_SAT_FIX,
    ODOMETRY,
    POSE_TYPES,
    TF,
    WHEEL_TYPES,
)
from slipwise.logs.namespaces import others_topics
from slipwise.logs.options import LogOptions
from slipwise.logs.role_choice import NONE, Role, RoleChoice, Topic, choose, listing
from slipwise.logs.topic_names import (
    COMMAND_NAMES,
    FUSED,
    MEASURED_OUTSIDE,
    POSE_NAMES,
    SATELLITES,
    WHEEL_NAMES,
    WHEEL_ODOMETRY,
    looks_like,
    score_of,
)
from slipwise.logs.transforms import TransformSource

_POSE = Role("pose", tuple(kind for kind in POSE_TYPES if kind != TF), POSE_NAMES)
_ANY_POSE = Role("pose", POSE_TYPES, POSE_NAMES)
_COMMAND = Role("command", COMMAND_TYPES, COMMAND_NAMES)
_WHEEL = Role("wheel", WHEEL_TYPES, WHEEL_NAMES)
_IMU = Role("imu", (IMU,), ((r"raw", -1, "its name says that it is raw, without an orientation"),))
NOTHING_YET = "no topic with"  # begins the sentence where a role has no topic: a robot may still start it
_MORE_POSES = 2  # TF is preferred where it has this many times the poses of the topic
_RECORD = "record where the robot went by something other than its wheels (RTK, lidar, motion capture)"
SIZES = "--wheel-radius and --wheel-separation"


@dataclass(frozen=True)
class TopicRoles:
    """The choice for each role; any may be a problem."""

    pose: RoleChoice
    command: RoleChoice
    wheel: RoleChoice
    imu: RoleChoice
    problem: LogError | None  # why the bag cannot be read with these
    guessed: tuple[str | Finding, ...]  # what was guessed, and what was found to be wrong
    advice: Mapping[str, str]  # what would give an input that is not read, by the input's name

    def named(self) -> tuple[tuple[str, RoleChoice], ...]:
        """Return the choices with the names of their roles."""
        return (("pose", self.pose), ("command", self.command), ("wheel", self.wheel), ("imu", self.imu))


def transforms_matter(topics: Sequence[Topic], options: LogOptions) -> bool:
    """Say whether TF has to be looked at before the pose can be chosen."""
    if options.poses is not None or not any(topic.type == TF and topic.count for topic in topics):
        return False
    pose = weigh_topics(topics, options).pose.topic
    return pose is None or pose.type == TF or not _measured_outside(pose)


@dataclass(frozen=True)
class Roles:
    """The chosen topics."""

    pose: Topic | None  # None where a file holds the poses
    command: Topic | None
    wheel: Topic | None
    imu: Topic | None
    guessed: tuple[str | Finding, ...]  # what was guessed, and what was found to be wrong
    advice: Mapping[str, str]  # what would give an input that is not read, by the input's name
    others: tuple[Topic, ...] = ()  # further sources of poses
    gyro: Topic | None = None  # whose yaw rates are read: beside positions without a heading


def choose_topics(
    topics: Sequence[Topic], options: LogOptions, transforms: TransformSource | None = None
) -> Roles:
    """Choose the topics by name and type, or take the ones given.

    Raises:
        LogError: a given topic is not there or has the wrong type, or the guess is unclear.
    """
    found = weigh_topics(topics, options, transforms)
    if found.problem is not None:
        raise found.problem
    command, wheel, imu = found.command.topic, found.wheel.topic, found.imu.topic
    others = tuple(_other_pose(topics, name) for name in options.other_pose_topics)
    gyro = _gyro(topics, found.pose.topic, imu, options)
    return Roles(found.pose.topic, command, wheel, imu, found.guessed, found.advice, others, gyro)


def turns_alone(options: LogOptions) -> bool:
    """Say whether no pose is to be read, but the yaw rates of an IMU that is named."""
    return options.pose_topic == NONE and options.imu_topic not in (None, NONE)


def _gyro(
    topics: Sequence[Topic], pose: Topic | None, imu: Topic | None, options: LogOptions
) -> Topic | None:
    """Return the IMU whose yaw rates go beside satellite fixes; one that is raw has a gyro at least."""
    if pose is None:
        return imu if turns_alone(options) else None
    if pose.type != NAV_SAT_FIX or options.imu_topic == NONE:
        return None
    raw = sorted((topic for topic in topics if topic.type == IMU and topic.count > 0), key=lambda t: t.name)
    return imu or next(iter(raw), None)


def _other_pose(topics: Sequence[Topic], name: str) -> Topic:
    """Return the topic of a further source of poses.

    Raises:
        LogError: it is not there or has another type.
    """
    found = choose({topic.name: topic for topic in topics if topic.count > 0}, _POSE, name)
    if found.problem is not None or found.topic is None:
        raise found.problem or LogError(f"there is no topic {name}", advice="see `slipwise inspect`")
    return found.topic


def weigh_topics(
    topics: Sequence[Topic], options: LogOptions, transforms: TransformSource | None = None
) -> TopicRoles:
    """Choose the topics as `choose_topics` does, but say what is unclear instead of raising it."""
    every = {topic.name: topic for topic in topics if topic.count > 0}
    foreign = _others_topics(every, options)
    live = {name: topic for name, topic in every.items() if name not in foreign}
    advice: dict[str, str] = {}
    pose = _choose_pose(live, options, transforms)
    command = choose(live, _COMMAND, options.command_topic)
    wheel = _choose_wheel(_beside_the_pose(live, options), options, advice)
    shared = pose.topic is not None and pose.topic == wheel.topic
    only_by_type = shared and options.wheel_topic is None and not _says_wheels(wheel.topic)
    if only_by_type and command.topic is not None:
        wheel = _without_wheels(wheel, "it is the pose, and its name does not say that it is wheel odometry")
        shared = False
    satellites = pose.topic is not None and pose.topic.type == NAV_SAT_FIX
    asked = satellites or options.imu_topic is not None
    imu = choose(live, _IMU, options.imu_topic) if asked else RoleChoice()
    if imu.problem is not None and options.imu_topic is None:  # any of several orientations will do
        first = next(t for t in live.values() if t.type == IMU and t.name in imu.rejected)
        imu = RoleChoice(first, "the first of several", imu.rejected)
    found = _with_foreign(TopicRoles(pose, command, wheel, imu, None, (), advice), every, foreign)
    problem = _problem(every, found, options, shared=shared)
    notes = _notes(found, options, transforms)
    said: list[str | Finding] = []
    for name, why in foreign.items():
        if wheel.topic is None and every[name].type in _WHEEL.kinds and "wheel" not in advice:
            said.append(other := OtherRobot.of(name, why, "--wheel-topic"))
            advice["wheel"] = other.sentence
        else:
            said.append(f"{name} is not used, since {why}")
    said += _silent(topics, {_COMMAND: command, _WHEEL: wheel}, options)
    return replace(found, problem=problem, guessed=(*notes, *said))


def _silent(topics: Sequence[Topic], chosen: Mapping[Role, RoleChoice], options: LogOptions) -> list[Finding]:
    """Say which topics without a message would be an input that is missing."""
    many = {_COMMAND: "commands", _WHEEL: "wheel speeds"}
    return [
        SilentTopic.of(topic.name, many[role])
        for role, choice in chosen.items()
        if choice.topic is None and choice.problem is None and role.given(options) != NONE
        for topic in topics
        if topic.count == 0
        and topic.type in role.kinds
        and score_of(topic.name, topic.type, role.names)[0] > 0
    ]


def _others_topics(live: Mapping[str, Topic], options: LogOptions) -> dict[str, str]:
    """Return the topics of other robots, and why."""
    roles_given = {
        **{role.name: role.given(options) for role in (_POSE, _COMMAND, _WHEEL)},
        **{f"pose {k}": name for k, name in enumerate(options.other_pose_topics, start=2)},
    }
    given = {
        role: name if name in live else f"/{name}"
        for role, name in roles_given.items()
        if name is not None and name != NONE
    }
    roles = {
        role.name: [
            topic.name
            for topic in live.values()
            if topic.type in role.kinds and score_of(topic.name, topic.type, role.names)[0] >= 0
        ]
        for role in (_POSE, _COMMAND, _WHEEL)
    }
    return others_topics(roles, given)


def _with_foreign(found: TopicRoles, live: Mapping[str, Topic], foreign: Mapping[str, str]) -> TopicRoles:
    """Say of each role which topics of other robots do not take it."""

    def beside(choice: RoleChoice, kinds: Sequence[str]) -> RoleChoice:
        lost = {name: why for name, why in foreign.items() if live[name].type in kinds}
        return replace(choice, rejected={**choice.rejected, **lost})

    return replace(
        found,
        pose=beside(found.pose, _POSE.kinds),
        command=beside(found.command, _COMMAND.kinds),
        wheel=beside(found.wheel, _WHEEL.kinds),
    )


def _beside_the_pose(live: Mapping[str, Topic], options: LogOptions) -> Mapping[str, Topic]:
    """Leave out the topic that is named as the pose: it is no wheel candidate where there is another."""
    pose = options.pose_topic
    if pose is None or options.wheel_topic is not None:
        return live
    others = {name: topic for name, topic in live.items() if name not in (pose, f"/{pose}")}
    found = _choose_wheel(others, options, {})
    return live if found.topic is None and found.problem is None else others


def _choose_pose(
    live: Mapping[str, Topic], options: LogOptions, transforms: TransformSource | None
) -> RoleChoice:
    if options.poses is not None:
        beside = {t.name: "--poses gives the poses" for t in live.values() if t.type in POSE_TYPES}
        return RoleChoice(rejected=beside)
    if options.pose_topic is not None:
        return choose(live, _ANY_POSE, options.pose_topic)
    tf = next((t for t in live.values() if t.type == TF and not t.name.endswith("static")), None)
    found = choose(live, _POSE, None)
    if options.pose_frame is not None or options.child_frame is not None:
        frames = "--pose-frame or --child-frame asks for TF"
        lost = dict.fromkeys([*found.rejected, *([found.topic.name] if found.topic else [])], frames)
        return RoleChoice(tf, frames, lost)
    if tf is None:
        return found
    if found.topic is None and found.problem is None:
        return RoleChoice(tf, "no other topic has a measured pose", found.rejected)
    if found.topic is not None and transforms is not None and _has_more(transforms, found.topic):
        slow, counts = found.topic.name, f"{transforms.samples} to {found.topic.count}"
        why = f"it has more poses than {slow} ({counts})"
        return RoleChoice(tf, why, {**found.rejected, slow: f"{tf.name} has more poses ({counts})"})
    return replace(found, rejected={**found.rejected, tf.name: _not_transforms(found.topic, transforms)})


def _has_more(transforms: TransformSource, topic: Topic) -> bool:
    """Say whether TF tells more than a localiser's topic; a sensor's own topic is never replaced."""
    if transforms.problem or transforms.odometry_alone or _measured_outside(topic):
        return False
    return transforms.samples >= _MORE_POSES * topic.count


def _measured_outside(topic: Topic) -> bool:
    score, _ = score_of(topic.name, topic.type, POSE_NAMES)
    return score >= MEASURED_OUTSIDE or topic.type == NAV_SAT_FIX or looks_like(topic.name, SATELLITES)


def _not_transforms(topic: Topic | None, transforms: TransformSource | None) -> str:
    if transforms is not None and transforms.problem:
        return transforms.problem
    if transforms is not None and transforms.odometry_alone:
        return f"{transforms.name} moves by odometry alone"
    return f"{topic.name} is preferred" if topic is not None else "topics are preferred"


def _choose_wheel(live: Mapping[str, Topic], options: LogOptions, advice: dict[str, str]) -> RoleChoice:
    """Choose the wheels; joint states only where the sizes of the robot are given."""
    sized = options.wheels is not None or (
        options.wheel_radius is not None and options.wheel_separation is not None
    )
    if options.wheel_topic is not None or sized:
        return choose(live, _WHEEL, options.wheel_topic)
    joints = [topic for topic in live.values() if topic.type == JOINT_STATE]
    others = {name: topic for name, topic in live.items() if topic.type != JOINT_STATE}
    found = choose(others, _WHEEL, None)
    needs = f"its wheel speeds need {SIZES}"
    if joints and found.topic is None and found.problem is None:
        names = ", ".join(topic.name for topic in joints)
        advice["wheel"] = f"{names} has joint states: give {SIZES} to read wheel speeds from it"
    return replace(found, rejected={**found.rejected, **{topic.name: needs for topic in joints}})


def _without_wheels(wheel: RoleChoice, why: str) -> RoleChoice:
    assert wheel.topic is not None
    return RoleChoice(rejected={**wheel.rejected, wheel.topic.name: why})


def _says_wheels(topic: Topic | None) -> bool:
    return topic is not None and looks_like(topic.name, WHEEL_ODOMETRY)


def _problem(
    live: Mapping[str, Topic], found: TopicRoles, options: LogOptions, *, shared: bool
) -> LogError | None:
    for choice in (found.wheel, found.command, found.pose, found.imu):
        if choice.problem is not None:
            return choice.problem
    if found.pose.topic is None and options.poses is None and not turns_alone(options):
        return LogError(f"{NOTHING_YET} a measured pose", advice=_pose_advice(live))
    if found.command.topic is None and found.wheel.topic is None:
        what = f"{NOTHING_YET} a command or with wheel speeds"
        advice = f"give --command-topic or --wheel-topic; {listing(live)}"
        return LogError(what, advice=found.advice.get("wheel", advice))
    if shared and found.pose.topic is not None:
        name = found.pose.topic.name
        return LogError(
            f"pose and wheel speeds both come from {name}, so the pose cannot show how the wheels slip",
            advice=f"{_RECORD}; if the pose of {name} is such, give --wheel-topic {NONE}",
        )
    return None


def _notes(found: TopicRoles, options: LogOptions, transforms: TransformSource | None) -> tuple[str, ...]:
    notes = [
        f"{role} topic: {choice.topic.name} ({choice.topic.type.replace('/msg/', '/')})"
        + (f": {choice.why}" if choice.topic.type == TF else "")
        for role, choice in found.named()
        if choice.topic and not getattr(options, f"{role}_topic")
    ]
    pose = found.pose.topic
    if pose is not None and options.pose_topic is None and looks_like(pose.name, FUSED):
        notes.append(f"{pose.name} is fused: it shows slip only if more than wheels and an IMU went into it")
    excluded = pose is not None and score_of(pose.name, pose.type, POSE_NAMES)[1]
    if pose is not None and excluded:
        notes.append(f"{pose.name} is the pose as given, although {excluded}")
    if pose is not None and pose.type == TF and transforms is not None and transforms.warning:
        notes.append(transforms.warning)
    return tuple(notes)


def _pose_advice(live: Mapping[str, Topic]) -> str:
    odometry = [topic.name for topic in live.values() if topic.type == ODOMETRY]
    if odometry:
        return (
            f"{', '.join(odometry)} looks like wheel odometry, which cannot show its own slip; "
            "give --pose-topic if its pose is measured from outside, or --poses FILE"
        )
    return f"give --pose-topic, or --poses FILE; {listing(live)}"
