# SPDX-License-Identifier: Apache-2.0
"""`slipwise excite --drive`: the robot drives the designed moves by itself, while a person holds a button."""

from __future__ import annotations

import math
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipwise.cli.errors import printable
from slipwise.errors import SettingsError

if TYPE_CHECKING:
    from slipwise.excitation import Excitation
    from slipwise.live.drive_guard import DriveBounds
    from slipwise.live.drive_link import DriveLink
    from slipwise.live.self_drive import DriveReport

SLOWEST_RATE, FASTEST_RATE = 10.0, 200.0  # Hz
LINES = ("stdin", "udp")


@dataclass(frozen=True)
class SelfDriveOptions:
    """What the command line says of a robot that drives by itself."""

    log: Path
    speed: float | None  # m/s
    dead_man: str | None
    button: int
    pose_topic: str | None
    topic: str
    stamped: bool
    rate: float  # Hz
    countdown: float  # s
    transport: str | None
    domain: int | None
    network: bool
    address: str | None

    def check(self) -> None:
        """Refuse what no robot should be driven with.

        Raises:
            SettingsError: speed limit, button or pose topic is missing, or a number makes no sense.
        """
        wanted: dict[str, object] = {"--speed": self.speed}
        if self.transport not in LINES:
            wanted |= {"--dead-man": self.dead_man, "--pose-topic": self.pose_topic}
        for option, value in wanted.items():
            if value is None:
                raise SettingsError(
                    "a robot that drives by itself needs it",
                    where=option,
                    advice="see `slipwise excite --help`",
                )
        if not SLOWEST_RATE <= self.rate <= FASTEST_RATE:
            raise SettingsError(
                f"{self.rate:g} commands a second",
                where="--rate",
                advice=f"give {SLOWEST_RATE:g} to {FASTEST_RATE:g}",
            )
        if not (math.isfinite(self.countdown) and self.countdown >= 0.0) or self.button < 0:
            raise SettingsError("a number makes no sense", where="--countdown, --dead-man-button")


def drive_by_itself(drive: Excitation, options: SelfDriveOptions) -> dict[str, Any]:
    """Drive, write what was driven, and return the exit code and the report for the document.

    What is said goes to standard error, whatever takes standard output.

    Raises:
        SlipwiseError: the robot's topics or the address cannot be used, or the log cannot be written.
    """
    from slipwise.cli.live import stopped_by_signals
    from slipwise.excitation.design import LEAD
    from slipwise.files import write_text_whole
    from slipwise.live.drive_guard import DriveGuard
    from slipwise.live.self_drive import DrivePlan, SelfDrive

    _say("the robot will drive by itself: stop button in hand, nobody in its area. Ctrl-C stops it, too")
    with stopped_by_signals() as stopping:
        link = open_link(options)
        try:
            guard = DriveGuard(bounds_of(drive))
            plan = DrivePlan(drive.moves, LEAD, options.rate, options.countdown)
            driver = SelfDrive(link, guard, plan, say=_say)
            stopping.node = driver
            report = driver.run()
        finally:  # what was driven is kept whatever ended it
            link.close()
            if link.log.commands:
                write_text_whole(options.log, link.log.text())
                _say(f"commands and poses: {options.log}; next: slipwise calibrate {options.log}")
    for line in summary_of(report, len(drive.moves), drive.seconds):
        _say(line)
    return {"exit_code": int(bool(report.why)), "driven": _finite(asdict(report)) | {"log": options.log}}


def bounds_of(drive: Excitation) -> DriveBounds:
    """Return the area about the start in which all of the robot stays, and the limits of the drive."""
    from slipwise.live.drive_guard import DriveBounds

    area, radius, (x, y) = drive.options.area, drive.options.radius, drive.start
    if area is None:
        raise SettingsError("a robot that drives by itself needs an area", where="--area")
    return DriveBounds(
        radius - x,
        area[0] - radius - x,
        radius - y,
        area[1] - radius - y,
        drive.space.speed,
        drive.space.yaw_rate,
    )


def open_link(options: SelfDriveOptions) -> DriveLink:
    """Return what carries commands and poses.

    Raises:
        SettingsError: the address or the wire cannot be used.
    """
    if options.transport == "stdin":
        from slipwise.live.drive_lines import PipeDriveLink

        return PipeDriveLink(sys.stdin, sys.stdout)
    if options.transport == "udp":
        from slipwise.live.drive_lines import UdpDriveLink
        from slipwise.live.udp import DEFAULT_ADDRESS

        listening = UdpDriveLink(options.address or DEFAULT_ADDRESS)
        _say(f"listening on UDP port {listening.port}")
        return listening
    from slipwise.live.drive_ros import DriveTopics, RosDriveLink
    from slipwise.live.wires.make_wire import make_wire
    from slipwise.live.wires.options import WireOptions

    named = WireOptions(node_name="slipwise_excite", domain=options.domain, network=options.network)
    if options.address is not None:
        named = replace(named, router=f"tcp/{options.address}")
    topics = DriveTopics(
        options.dead_man or "", options.pose_topic or "", options.topic, options.stamped, options.button
    )
    wire = make_wire(None if options.transport in (None, "ros") else options.transport, named)
    try:
        return RosDriveLink(wire, topics)
    except BaseException:
        wire.close()
        raise


def summary_of(report: DriveReport, moves: int, seconds: float) -> list[str]:
    """Return what came of the drive in sentences."""
    if not report.commands:
        return ["the robot was not commanded"]
    end = f"stopped: {report.why}" if report.why else "driven to its end"
    amount = f"{report.moves} of {moves} moves, {report.seconds:.1f} of {seconds:.1f} s"
    lines = [f"{end}; {amount}, {report.commands} commands, {report.poses} poses"]
    if math.isfinite(report.room_left):
        lines.append(f"the robot came as near to the edge of its area as {report.room_left:.2f} m")
    if math.isfinite(report.stopped_after):
        lines.append(
            f"the command to stand was sent {1e3 * report.stopped_after:.0f} ms after what made it stop"
        )
    return lines


def _say(text: str) -> None:
    print(printable(text), file=sys.stderr, flush=True)


def _finite(content: dict[str, Any]) -> dict[str, Any]:
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in content.items()
    }
