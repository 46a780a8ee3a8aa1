# SPDX-License-Identifier: Apache-2.0
"""What readers and live nodes find to be wrong with clocks: set back, apart, too fast, in the future."""

from __future__ import annotations

from slipwise.logs.findings.finding import Check, Finding


class ClockSetBack(Check):
    """A clock that was set back, in a bag, a table or live."""

    kind, family, spoils = "clock-set-back", "clocks", False
    means = "the clock was set back: NTP, a simulation that was reset, a bag that was played twice"
    shows = "five stamps in a row that agree are a second and more behind"
    cure = "none: a new run begins there; on the robot, let the clock settle before recording"

    @classmethod
    def by(cls, seconds: float, where: str = "") -> Finding:
        """Say by how much [s]."""
        return cls.found(
            f"the clock was set back by {seconds:.1f} s: a new run begins{where}",
            "Nothing is joined across it; record after the clocks have settled (NTP, use_sim_time).",
            evidence=seconds,
        )


class ClockApart(Check):
    """Headers on another clock than the recorder's."""

    kind, family, spoils = "clock-apart", "clocks", False
    means = "header stamps are on another clock than the one that records"
    shows = "they are 0.02 s ahead of receipt, or 1 s and more behind"
    cure = "none where all streams have headers; else synchronise the computers (chrony, PTP)"

    @classmethod
    def by(cls, lead: float, whose: str, dated: str) -> Finding:
        """Say by how much headers are ahead of receipt [s], and how what has none is dated."""
        side = "ahead of" if lead > 0.0 else "behind"
        return cls.found(
            f"header stamps are on another clock, {abs(lead):.2f} s {side} {whose}'s{dated}",
            "Synchronise the clocks of the computers, or stamp commands (TwistStamped).",
            evidence=lead,
        )


class ClockRate(Check):
    """Headers whose time runs at another rate: simulated time, or a clock that drifts."""

    kind, family, spoils = "clock-rate", "clocks", False
    means = "header stamps run at another rate than real time, while something else is dated by receipt"
    shows = "the slope of stamps over receipt is off by 0.5 % and more"
    cure = "`use_sim_time` for every node, `ros2 bag record --use-sim-time`; others are dated by it"

    @classmethod
    def by(cls, rate: float, dated: str) -> Finding:
        """Say how fast headers run [s/s], and how what has none is dated."""
        return cls.found(
            f"header stamps run at {rate:.3g} of the bag's clock{dated}",
            "Where this is a simulation, set use_sim_time for every node and record with --use-sim-time.",
            evidence=rate,
        )


class ClockOfTopic(Check):
    """One topic on another clock than the poses."""

    kind, family, spoils = "clock-of-topic", "clocks", False
    means = "one topic is stamped by another computer's clock than the poses"
    shows = "against receipt it is 0.5 s off the poses' clock (0.07 s where one of them is the recorder's)"
    cure = "none: its stamps are shifted; synchronise the computers (chrony, PTP)"

    @classmethod
    def by(cls, topic: str, seconds: float) -> Finding:
        """Say by how much its stamps are shifted [s]."""
        return cls.found(
            f"the clock of {topic} is not that of the poses: {seconds:+.2f} s are added to its stamps",
            f"Synchronise the clock of the computer that publishes {topic} (chrony, PTP).",
            evidence=seconds,
        )


class ClockSlewed(Check):
    """One topic whose clock moves against that of the poses."""

    kind, family, spoils = "clock-slewed", "clocks", False
    means = "a computer's clock is pulled to another's (NTP, chrony) while it records, or drifts"
    shows = "over the recording the stamps of a topic move by 0.1 s and more against those of the poses"
    cure = "let the clocks settle before recording (`chronyc waitsync`); `--start` leaves the beginning out"

    @classmethod
    def by(cls, topic: str, seconds: float) -> Finding:
        """Say by how much its stamps move over the recording [s]."""
        return cls.found(
            f"the stamps of {topic} move by {seconds:+.2f} s against those of the poses over the recording: "
            "a clock is pulled to another (NTP), or drifts",
            "Let the clocks settle before recording (chronyc waitsync); one clock offset cannot mend it.",
            evidence=seconds,
        )


class NoClock(Check):
    """Stamps that follow no clock."""

    kind, family, spoils = "no-clock", "clocks", False
    means = "the stamps of a topic follow no clock: frozen, random, or of another rate than the poses'"
    shows = "stamps scatter about a straight line over receipt by a tenth of the recording"
    cure = "none: it gets the time of receipt; correct the driver's header.stamp"

    @classmethod
    def of(cls, topic: str) -> Finding:
        """Say of which topic."""
        return cls.found(
            f"the stamps of {topic} do not follow the bag's clock: it gets the time of receipt",
            f"Correct header.stamp in the node that publishes {topic}.",
        )


class PostdatedPoses(Check):
    """Corrections of a localiser that are stamped in the future."""

    kind, family, spoils = "postdated-poses", "clocks", False
    means = "a localiser stamps `map -> odom` into the future (`transform_tolerance`)"
    shows = "the stamp is later than the receipt on the odometry's clock by more than 0.05 s"
    cure = "none: each correction is dated by its odometry; else `transform_tolerance: 0.1`"

    @classmethod
    def by(cls, name: str, late: float) -> Finding:
        """Say which transform, and by how much [s]."""
        return cls.found(
            f"{name} is stamped {late:.2f} s later than it is received (a transform tolerance): each "
            "correction is dated by the odometry that it was computed from",
            "Other tools move each correction by it: lower transform_tolerance of the localiser for them.",
            evidence=late,
        )


CLOCKS: tuple[Check, ...] = (
    ClockSetBack(),
    ClockApart(),
    ClockRate(),
    ClockOfTopic(),
    ClockSlewed(),
    NoClock(),
    PostdatedPoses(),
)
