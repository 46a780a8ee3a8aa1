# SPDX-License-Identifier: Apache-2.0
"""What readers find to be wrong with topics: of another robot, without a twist, in a lost file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from slipwise.logs.findings.finding import Check, Finding

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog


class OtherRobot(Check):
    """A topic of another robot."""

    kind, family, spoils = "other-robot", "topics", False
    means = "the bag holds topics of several robots, by their namespaces"
    shows = "a topic that could be used has another robot's name"
    cure = "`--wheel-topic`, `--command-topic`, `--pose-topic`, or record one namespace"

    @classmethod
    def of(cls, topic: str, why: str, option: str) -> Finding:
        """Say which topic is not used, and the option that takes it."""
        return cls.found(f"{topic} is not used, since {why}: else give {option} {topic}")


class SilentTopic(Check):
    """A topic that nobody publishes."""

    kind, family, spoils = "silent-topic", "topics", False
    means = "a topic of wheels or commands is in the bag without a message: nobody publishes it"
    shows = "0 messages, and no other topic in its place"
    cure = "start or remap its publisher (`ros2 topic info -v`); or name another topic"

    @classmethod
    def of(cls, topic: str, role: str) -> Finding:
        """Say which topic, and what it would be."""
        return cls.found(
            f"{topic} has no messages, and no other topic has {role}: nobody publishes it",
            f"ros2 topic info -v {topic} names its publishers: start or remap one, or name another topic.",
            evidence=0.0,
        )


class ZeroTwist(Check):
    """An odometry whose twist stays zero."""

    kind, family, spoils = "zero-twist", "topics", False
    means = "the twist of an odometry is always zero though its pose moves"
    shows = "all twists are 0 while the pose leaves its start by 0.05 m or 0.05 rad"
    cure = "none: wheel speeds are differences of its poses; correct the driver's `twist`"

    @classmethod
    def of(cls, topic: str) -> Finding:
        """Say of which topic."""
        return cls.found(
            f"the twist of {topic} is always zero though its pose moves: wheel speeds are differences of its "
            "poses",
            f"Fill twist in the node that publishes {topic}.",
        )


class NoRotation(Check):
    """Poses whose quaternions are no rotations."""

    kind, family, spoils = "no-rotation", "poses", False
    means = "poses have a position and no rotation, such as the quaternion 0 0 0 0"
    shows = "not one quaternion of the topic has a length"
    cure = "none: read as positions; live `--set live.positions=true`"

    @classmethod
    def of(cls, topic: str, count: int, first: str) -> Finding:
        """Say of which topic, how many there are, and the first quaternion."""
        return cls.found(
            f"the quaternions of all {count} poses of {topic} are no rotations, such as ({first}): "
            "only their positions are used, and headings are the direction of the path",
            f"Fill the orientation in the node that publishes {topic} to learn side slip too.",
            evidence=count,
        )


class ZeroCovariance(Check):
    """Poses that say of themselves that they are exact, in the message that is made to say how sure they are.

    Of an `Odometry` zeros are usual, and say nothing.
    """

    kind, family, spoils = "zero-covariance", "poses", False
    means = "all covariances of the poses are zero"
    shows = "every variance in 20 `PoseWithCovarianceStamped` and more is 0 (in `Odometry` that is usual)"
    cure = "none: the scatter is learned; fill the covariance for who fuses them"
    FEWEST = 20  # poses

    @classmethod
    def of(cls, topic: str, count: int) -> Finding:
        """Say of which topic, and of how many poses."""
        return cls.found(
            f"the covariances of all {count} poses of {topic} are zero: a filter that fuses them "
            "(robot_localization) takes them for exact",
            f"Fill covariance in the node that publishes {topic}; slipwise learns how far poses scatter.",
            evidence=count,
        )


class MissingFile(Check):
    """A file of a split bag that is not there."""

    kind, family, spoils = "missing-file", "topics", False
    means = "a file that `metadata.yaml` lists is not there"
    shows = "its name"
    cure = "copy the whole folder; a silence begins a new run"

    @classmethod
    def of(cls, sentence: str) -> Finding:
        """Say it in these words."""
        return cls.found(sentence, "Copy the whole folder from the robot.")


class ArmJoints(Check):
    """Joint states without a wheel's joint among those of the wheels."""

    kind, family, spoils = "no-wheel-joint", "topics", False
    means = "an arm and a base publish joint states on one topic in turn"
    shows = "messages without a wheel's joint"
    cure = "none: they are skipped; `--left-joints`, `--right-joints` name the wheels"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at what was left out."""
        left = next((each for each in whole.log.left_out if each.kind == self.kind), None)
        if left is None:
            return None
        return self.found(
            f"{left.count} x {left.reason}: another publisher takes turns on the topic",
            "They are skipped; --left-joints and --right-joints name the wheels where the guess is wrong.",
            evidence=left.count,
        )


TOPICS: tuple[Check, ...] = (
    OtherRobot(),
    SilentTopic(),
    ZeroTwist(),
    NoRotation(),
    ZeroCovariance(),
    MissingFile(),
    ArmJoints(),
)
