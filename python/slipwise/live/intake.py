# SPDX-License-Identifier: Apache-2.0
"""What happens to a sample before it is learned: its clock, the gates, and what the learner makes of it."""

from __future__ import annotations

import math
from dataclasses import replace

from slipwise.calibration.learner_answers import Event
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.mounts import Mount
from slipwise.calibration.settings_for_log import takes_ground_for_level
from slipwise.live.clock_watch import ClockWatch, PoseSteps
from slipwise.live.command_stops import SAID_EVERY, CommandEnds, LiveCommandStops
from slipwise.live.gates import Gates
from slipwise.live.move_adviser import Turning
from slipwise.live.recent_log import RecentLog
from slipwise.live.said import Said
from slipwise.live.samples import (
    Command,
    DriveStart,
    KnownForce,
    Pose,
    Reading,
    Stamped,
    SurfaceCue,
    Twist,
    Wheels,
)
from slipwise.live.surface_watch import SurfaceWatch
from slipwise.logs.attitude import was_measured
from slipwise.logs.findings.clocks import ClockSetBack
from slipwise.logs.findings.finding import Finding
from slipwise.logs.gyro import COLUMN as GYRO

MOST_FRAMES = 1000  # whose names are kept
TILTED_LATER = (
    "the first poses were level, and now they have roll and pitch: these are used, but terms of gravity are "
    "not tried; `slipwise calibrate` of a recording tries them, as a node does that starts on a slope"
)


class Intake:
    """Pushes samples into a learner. Inputs always count; poses are learned from while the gates are open."""

    def __init__(
        self,
        learner: MotionLearner,
        gates: Gates,
        said: Said,
        *,
        input_name: str,
        command_timeout: float | None = None,
    ) -> None:
        self._ends = CommandEnds(command_timeout, learner.settings.segment.unknown_after)
        self._learner, self._gates, self._said = learner, gates, said
        self._input = Command if input_name == "command" else Wheels
        unknown_after = learner.settings.segment.unknown_after
        self._stops = LiveCommandStops(unknown_after, command_timeout) if input_name == "command" else None
        self._pose_steps = PoseSteps()
        sensor = learner.settings.sensor_extrinsics
        self._recent = RecentLog(input_name, unknown_after, sensor.pose)
        self._clock = ClockWatch()
        self.surfaces = SurfaceWatch(learner, said)
        self._level = takes_ground_for_level(learner.settings)
        self.turning = Turning()
        self._looked_at = math.inf  # s, when it was looked how commands end
        self._frames: dict[str, int] = {}
        self._next_frame = 0
        self.newest_input: Twist | None = None
        self.newest_pose: Pose | None = None
        self.why_not = ""  # nothing is learned now
        self._source: str | None = None  # of poses, where sources are not told apart
        self._mounting = ""  # of the sensor of roll and pitch, as it was said

    @property
    def newest(self) -> float:
        """Stamp of the newest sample that was taken [s]; minus infinity before the first."""
        return self._clock.newest

    def teaches(self, sample: Stamped) -> bool:
        """Whether a model is learned from samples of its kind, so that it is time to look at it."""
        return isinstance(sample, Pose) or (self._learner.gyro_alone and _of_gyro(sample))

    def start_run(self, name: str) -> None:
        """Begin a recording: nothing is joined across runs."""
        self._restart()
        self.surfaces.start_run(name)

    def start_drive(self, name: str, drive: DriveStart) -> None:
        """Begin a recording after a while or elsewhere: any surface may be under the robot."""
        self._restart()
        self.surfaces.start_drive(name, drive)

    def take_cue(self, cue: SurfaceCue) -> None:
        """Take a label of the ground: it holds from now on."""
        self.surfaces.take(cue, self.newest)

    def take(self, sample: Stamped) -> None:
        """Take one sample in the order in which it came."""
        taken = self._clock.take(sample)
        if self._clock.dropped:
            self._said.count("a stamp that no other agrees with", number=self._clock.dropped)
            self._clock.dropped = 0
        if self._clock.set_back_by is not None:
            self._said.note(self._clock.newest, ClockSetBack.by(self._clock.set_back_by).sentence)
            self._said.count("the clock was set back")
            self.surfaces.start_run(f"after the clock was set at {self._clock.newest:.3f} s")
            self._restart_streams()
        for each in taken:
            self._keep(each)
            for zero in self._ends.before(each):
                self._push(zero)
            self._gates.take(each)
            self._push(each)

    def _keep(self, sample: Stamped) -> None:
        """Keep what the learner takes for a while; whose poses it does not know it does not take."""
        if not isinstance(sample, Pose):
            self._recent.take(sample)
            return
        pose = sample if self._learner.tells_sources else self._of_one_source(sample)
        if self._learner.knows_source(pose.source):
            self._recent.take(pose, further=not self._learner.is_first(pose.source))

    def contradictions(self) -> tuple[Finding, ...]:
        """Return what a stream shows that the learner does not keep, such as how commands end."""
        no_seconds = self._pose_steps.found()
        if no_seconds is not None:  # all else follows from it
            return (no_seconds,)
        stops = () if self._stops is None else self._stops.found()
        return (*stops, *self._recent.found())

    def mounts(self, *, last: bool) -> tuple[Mount, ...]:
        """Return where further sources of poses sit, by what came so far; `last`: nothing more comes."""
        return self._recent.mounts(last=last)

    def events(self) -> list[Event]:
        """Return what the learner has to say since the last call; what it rejected is counted."""
        events = self._learner.events()
        for event in events:
            if event.kind == "rejected":
                self._said.count(event.reason)
        return events

    def _restart(self) -> None:
        self._clock.restart()
        self._restart_streams()

    def _restart_streams(self) -> None:
        """Stamps begin again."""
        self._ends.restart()
        self._gates.restart()
        self._recent.restart()
        self._pose_steps.restart()
        if self._stops is not None:
            self._stops.restart()

    def _push(self, sample: Stamped) -> None:
        learner = self._learner
        if isinstance(sample, self._input):
            self.newest_input = sample
            self.turning.take(sample)
        if isinstance(sample, Command):
            if self._stops is not None:
                self._stops.take_command(sample)
            learner.push_command(sample.t, sample.v, sample.omega, sample.vy)
        elif isinstance(sample, Wheels):
            learner.push_wheels(sample.t, sample.v, sample.omega, sample.vy)
        elif isinstance(sample, KnownForce):
            learner.push_force(sample.t, sample.x, sample.y)
        elif isinstance(sample, Reading):
            self._push_reading(sample)
        elif isinstance(sample, Pose):
            self._push_pose(sample if learner.tells_sources else self._of_one_source(sample))

    def _push_reading(self, sample: Reading) -> None:
        learner, gyro = self._learner, _of_gyro(sample)
        if gyro and not (learner.gyro_alone or learner.positions):
            self._said.count("turns of a gyro, which poses with a heading tell themselves")
            return
        if gyro and learner.gyro_alone:
            self._follow_gates(sample.t)
            if self.why_not:
                self._said.count(f"turns not learned from: {self.why_not}")
                return
        learner.push_reading(sample.t, sample.column, sample.value)

    def _of_one_source(self, pose: Pose) -> Pose:
        """The poses of the source that speaks first, where sources are not told apart."""
        if self._source is None:
            self._source = pose.source
        return replace(pose, source="") if pose.source == self._source else pose

    def _push_pose(self, pose: Pose) -> None:
        if self._learner.gyro_alone:
            self._said.count("poses, where turns of a gyro alone are learned from")
            return
        if not self._learner.knows_source(pose.source):
            self._said.count(f"poses of '{pose.source}', which is none of the sources of [live]")
            return
        if not self._learner.is_first(pose.source):
            self._push_other(pose)
            return
        if math.isnan(pose.yaw) and not self._learner.positions:
            self._said.count("a pose without a heading, where poses are learned from")
            return
        self.newest_pose = pose
        self._follow_gates(pose.t)
        learned = not self.why_not
        if not learned:
            self._said.count(f"poses not learned from: {self.why_not}")
        if pose.roll is not None and pose.pitch is not None:
            self._learner.push_attitude(pose.t, pose.roll, pose.pitch)
            self._say_mounting(pose.t)
            if self._level and was_measured(pose.roll) and was_measured(pose.pitch):
                self._said.once(pose.t, "attitude", TILTED_LATER)
        number = self._frame_number(pose.frame)
        self._pose_steps.take(pose.t)
        if self._stops is not None:
            self._stops.take_pose(pose, number)
        self._say_steps(pose.t)
        self._learn(pose, number, learned=learned)

    def _say_steps(self, t: float) -> None:
        """Say where stamps are not in seconds, or commands come so rarely that little can be learned."""
        found = self._pose_steps.found()
        if found is not None:
            words = f"{found.sentence}. {found.advice[0][0].upper()}{found.advice[0][1:]}."
            self._said.begins(t, "seconds", words, error=True)
        elif self._stops is not None and self._pose_steps.enough:
            self._say_stops(self._stops, t)

    def _say_stops(self, stops: LiveCommandStops, t: float) -> None:
        if self._looked_at <= t < self._looked_at + SAID_EVERY:
            return
        self._looked_at = t
        words = stops.words()
        if words:
            self._said.begins(t, "commands", words)

    def _say_mounting(self, t: float) -> None:
        """Say how the sensor of roll and pitch is mounted, where that is another than was said."""
        words = self._learner.attitude_mounting
        if words != self._mounting:
            self._said.note(t, words or "roll and pitch come from a level sensor")
            self._mounting = words

    def _push_other(self, pose: Pose) -> None:
        """A further source: where the gates are closed nothing is learned from it either."""
        number = self._frame_number(f"{pose.source} {pose.frame}")
        self._learn(pose, number, learned=not self._gates.why(pose.t))

    def _frame_number(self, name: str) -> int:
        """The number of a frame; of more than are kept, the oldest is a new one where it comes again."""
        if name not in self._frames:
            if len(self._frames) >= MOST_FRAMES:
                self._frames.pop(next(iter(self._frames)))
            self._frames[name] = self._next_frame
            self._next_frame += 1
        return self._frames[name]

    def _learn(self, pose: Pose, number: int, *, learned: bool) -> None:
        learner, source = self._learner, pose.source
        fix = pose.fix if learner.tells_sources else ""
        if math.isnan(pose.yaw) or (learner.positions and not source):
            learner.push_position(
                pose.t, pose.x, pose.y, pose.std_xy, number, learned=learned, source=source, fix=fix
            )
            return
        learner.push_pose(
            pose.t,
            pose.x,
            pose.y,
            pose.yaw,
            pose.std_xy,
            pose.std_yaw,
            number,
            learned=learned,
            source=source,
            fix=fix,
        )

    def _follow_gates(self, t: float) -> None:
        """Say when the gates close and open; the learner joins nothing across what it did not learn."""
        why = self._gates.why(t)
        if why:
            self._said.begins(t, "gates", f"learning paused: {why}")
        elif self.why_not:
            self._said.ends(t, "gates", "learning resumed")
        self.why_not = why


def _of_gyro(sample: Stamped) -> bool:
    return isinstance(sample, Reading) and sample.column == GYRO
