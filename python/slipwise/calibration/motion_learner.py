# SPDX-License-Identifier: Apache-2.0
"""Learning from one measurement at a time, as on a robot; `calibrate` pushes logs through the same."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from slipwise import _core
from slipwise.argument_types import check_arguments
from slipwise.calibration.calibrate import JUDGING_HORIZONS, model_of, model_of_log
from slipwise.calibration.coming import Coming
from slipwise.calibration.core_settings import NOTHING_PARTICULAR, car_of, core_settings, wheelbase_of
from slipwise.calibration.inputs_seen import SidewaysSeen, WheelStep
from slipwise.calibration.judge import Sensors, judge, to_judge
from slipwise.calibration.judgement import Judgement
from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import found_limits, held_out_predictions, learned_now
from slipwise.calibration.learner_answers import Event, MotionState, Odometry, event_of, odometry_of
from slipwise.calibration.measurements import Measurements
from slipwise.calibration.model_content import ModelFacts, model_content
from slipwise.calibration.mounts import Mount
from slipwise.calibration.path_ahead import PathAhead
from slipwise.calibration.prepared_run import used_sources
from slipwise.calibration.remembered_surfaces import RememberedSurfaces
from slipwise.calibration.same_log import learned_again
from slipwise.calibration.settings import AVERAGE, Settings, make_settings
from slipwise.calibration.settings_for_log import for_ground, for_positions
from slipwise.calibration.source_knowledge import LearnedSource, learned_sources
from slipwise.calibration.surface_sections import with_memory
from slipwise.calibration.verdict import LogFacts
from slipwise.errors import SettingsError
from slipwise.logs.findings.checks import findings_in, findings_of_log, findings_of_others, not_shown_yet
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import Seen, WholeLog
from slipwise.logs.findings.steering import Commanded
from slipwise.logs.log import Log, Scale
from slipwise.models import Model, parse_model
from slipwise.models.schema import LogReference, ModelFile, Range

if TYPE_CHECKING:
    from collections.abc import Callable

_NOTHING = "push inputs and poses of some seconds first; events() says what was rejected, and why"
_LENGTH_BYTES = 8  # of what stands before the core's bytes


class MotionLearner(Measurements, PathAhead, RememberedSurfaces):
    """Takes measurements as they come; each stream in the order of its stamps.

    Streams may be late relative to each other by up to half a second. What is wrong is rejected, counted
    and said by `events`; no push raises for what was measured.
    """

    def __init__(
        self,
        input: str = "command",
        settings: Settings | None = None,
        *,
        coming: Coming = NOTHING_PARTICULAR,
        remember: bool = False,
        wheelbase: float | None = None,
    ) -> None:
        """Start with nothing learned.

        Args:
            input: "command" or "wheel": what motion is predicted from.
            settings: what to learn and how.
            coming: what will be measured, where it is not poses of one source on level ground.
            remember: keep the surfaces that are driven on, and recall them where they come back.
            wheelbase: of a robot that is commanded to steer [m]: delay and lag act on its steering. By
                default that of the vehicle in the settings.

        Raises:
            SettingsError: there is no such input, basis or term, two sources have one name, or the
                estimator is another than the average.
        """
        sources = coming.sources
        if len(set(sources)) < len(sources):
            raise SettingsError(f"two sources have one name: {', '.join(sources)}", advice="name each apart")
        if input not in ("command", "wheel"):
            raise SettingsError(f"unknown input '{input}'", advice="use 'command' or 'wheel'")
        settings = settings or Settings()
        if settings.estimator != AVERAGE:
            raise SettingsError(
                f"the estimator {settings.estimator!r} learns whole logs alone",
                advice=f"leave out estimator: {AVERAGE!r} learns from one measurement at a time",
            )
        self._input = input
        settings = for_positions(settings) if coming.positions else settings
        self._settings = for_ground(settings, slopes=coming.attitude, sideways=coming.sideways)
        self._wheelbase = wheelbase_of(self._settings) if wheelbase is None else wheelbase
        self._core = _core.MotionLearner(
            core_settings(
                self._settings,
                input,
                JUDGING_HORIZONS,
                coming=coming,
                remember=remember,
                car=car_of(self._settings),
                wheelbase=self._wheelbase,
            )
        )
        self._gyro_alone = coming.gyro_alone
        self._sources = {name: number for number, name in enumerate(sources)}
        self._positions = coming.positions
        self._runs: list[str] = []
        self._wheels = False
        self._wheel_step = WheelStep()
        self._sideways = {name: SidewaysSeen() for name in ("command", "wheel")}
        self._remember = remember
        self._limits = None  # not saved
        self._start: Model | None = None  # that it began with
        self._of_log: tuple[Finding, ...] = ()  # what only a whole log shows
        self._of_others: tuple[Finding, ...] = ()  # of further sources of poses in it
        self._mounts: tuple[Mount, ...] = ()  # of further sources, as a stream shows them
        self._log_known = False
        self._logs: dict[str, str] = {}  # that were pushed, where they are known: paths by their SHA-256
        self.found: tuple[Finding, ...] = ()  # what was wrong at the last judgement of a stream
        self._clocks_compared = False
        self._scale: Scale | None = None  # of the input, as it is read

    def start_run(self, name: str) -> None:
        """Begin a run: nothing is joined across runs; what was learned stays."""
        self._name_run(name)
        self._core.start_run()

    def events(self) -> list[Event]:
        """Return what happened since the last call."""
        return [event_of(event, self._run(event.run)) for event in self._core.events()]

    def odometry(self) -> Odometry | None:
        """Return where the robot is at the newest measurement; None before the first pose of the run.

        Measured poses correct what the learned motion predicts since the last of them: slip, lag and delay as
        they are known, with their uncertainty. A pose that comes late takes effect at its stamp; lone poses
        far away move nothing. It does not change the learned model, and it is not saved: a learner that was
        loaded begins again with the next pose, since the robot may have been moved meanwhile. Call it at
        least every few seconds: after ten seconds of poses without a call, it begins again within
        them.
        """
        found = self._core.odometry()
        return None if found is None else odometry_of(found)

    def motion_monitor(self) -> MotionState:
        """Return whether the robot moves as its inputs and the learned model say it must.

        It is stuck where the poses of the last 0.6 s are explained by a robot that moves by a fifth of that
        at most, far better than by one that moves as expected, and this for 0.2 s. Nothing is said where less
        than 20 s were learned, inputs are not known or have just ended, or too little motion is expected
        beside the noise of the poses. It does not change the learned model, and it is not saved. Call it
        several times a second.
        """
        state = self._core.motion_monitor()
        return MotionState(stuck=state.stuck, fraction=state.fraction, since=state.since)

    def forget(self, fraction: float) -> None:
        """Give what is the terrain's `fraction` of its prior variance back: a cue from any other sensor.

        Raises:
            SettingsError: the fraction is not between 0 and 1.
        """
        try:
            self._core.forget(fraction)
        except ValueError as problem:
            raise SettingsError(str(problem)) from problem

    def start_drive(self, name: str, *, label: str = "", date: str = "") -> None:
        """Begin a run after a while or elsewhere: any surface that is remembered may be under the robot.

        Args:
            name: of the run.
            label: name of the surface, if a label names it; a wrong one is overruled.
            date: of the drive, for the table of surfaces.
        """
        self._name_run(name)
        self._core.start_drive(label, date)

    def model(self, *, limits: bool = True) -> Model:
        """Return the model of all that was pushed, with its verdict, as `calibrate` writes it of a log.

        Args:
            limits: look for limits of the actuator in the last minutes, and keep them where they predict
                better. This takes up to seconds; without, lag and delay stand for what limits do.

        Raises:
            SettingsError: nothing was learned yet.
        """
        return self.judged_model(limits=limits)[0]

    @property
    def learned(self) -> bool:
        """Whether anything was learned yet, so that there is a model to judge."""
        return bool(self._core.model().segments)

    @property
    def sources(self) -> tuple[LearnedSource, ...]:
        """Estimates of each pose source, where there are several."""
        if not self._sources:
            return ()
        return learned_sources(self._core.completed(), tuple(self._sources))

    @property
    def settings(self) -> Settings:
        """What the learner learns and how."""
        return self._settings

    def judged_model(self, *, limits: bool = True, log: Log | None = None) -> tuple[Model, Judgement]:
        """Return what `model` does, and how its predictions compare with the kinematic baseline's.

        Args:
            limits: as `model` takes it.
            log: where all that was pushed comes from: the model is then what `calibrate` makes of it.

        Raises:
            SettingsError: nothing was learned yet.
            LogError: no model holds such parameters; measurements that contradict themselves lead there.
        """
        model = self._core.model()
        if model.segments == 0:
            raise SettingsError("nothing was learned yet", advice=_NOTHING)
        learned = self._learned(model, limits=limits)
        if log is not None:
            made, judgement = model_of_log(learned, log, self._input, self._settings, self._start)
            return model_of(self._remembered(made.content, learned), log, ()), judgement
        sensors = Sensors(self._wheels, "", self._gyro_alone)
        first = findings_in(self._seen(model.evidence))
        others = (each for each in self._of_others if each.kind not in {one.kind for one in first})
        found = self.found = (*first, *others, *self._of_log)
        facts = LogFacts(found, (), self._input, self._positions, self._clocks_compared)
        judged = judge(to_judge(learned, self._settings, sensors, positions=self._positions), facts)
        slowest, fastest, right, left = model.range
        origin = ModelFacts(
            input_name=self._input,
            settings=self._settings,
            logs=[LogReference(path=path, sha256=sha256) for sha256, path in self._logs.items()],
            range=Range(
                speed=[slowest, fastest],
                yaw_rate=[right, left],
                sideways=self._sideways[self._input].span,
                slope=model.steepest,
                wheel_step=self._wheel_step.seconds,
            ),
            seconds=model.seconds,
            segments=model.segments,
            positions=self._positions,
            scale=self._scale,
        )
        content = self._remembered(model_content(learned, judged, origin), learned)
        return model_of(content, Log(()), found, self._mounts), judged.judgement

    def know_log(self, log: Log) -> None:
        """Take what a whole log shows beside the measurements that are pushed from it."""
        unknown_after = self._settings.segment.unknown_after
        shown = findings_of_log(WholeLog(log, self._input, unknown_after))
        again = learned_again(log, self._logs, "the learner")
        self._of_log, self._log_known = (*shown, *again), True
        self._of_others = findings_of_others(log, self._input, unknown_after, ())
        self._logs |= {source.sha256: source.path for source in used_sources(log, self._input)}
        self.know_clocks(compared=log.clocks_compared)

    def know_stream(self, found: tuple[Finding, ...], mounts: tuple[Mount, ...] = ()) -> None:
        """Take what a stream shows beside what the learner keeps; a whole log shows it better."""
        if not self._log_known:
            self._of_log, self._mounts = found, mounts

    def know_clocks(self, *, compared: bool) -> None:
        """Take whether stamps were compared with the times of arrival: a delay beyond 1 s is then real."""
        self._clocks_compared = compared

    def know_scale(self, scale: Scale) -> None:
        """Take what the speed and the yaw rate of the input are multiplied by, as they are read."""
        self._scale = None if scale == (1.0, 1.0) else scale

    def contradictions(self) -> tuple[Finding, ...]:
        """Return what shows that poses and inputs cannot both be right, of all that was pushed."""
        return findings_in(self._seen(self._core.model().evidence))

    @property
    def compared(self) -> int:
        """How much of the driving was looked at for contradictions: it grows while the robot is driven."""
        return self._core.compared

    def not_shown_yet(self) -> str:
        """Say what is missing until contradictions would have shown themselves; empty where nothing is."""
        return not_shown_yet(self._seen(self._core.model().evidence))

    def _seen(self, evidence: _core.MotionEvidence) -> Seen:
        throttle = car_of(self._settings) is not None
        return Seen(
            evidence=evidence,
            runs=self._runs,
            input_name=self._input,
            positions=self._positions,
            gyro=self._positions or self._gyro_alone,
            sensor=self._settings.sensor_extrinsics.pose,
            commanded=Commanded(
                steered=bool(self._wheelbase) and not throttle,
                sideways=self._sideways["command"].span is not None,
                throttle=throttle,
            ),
        )

    def _remembered(self, content: ModelFile, learned: Learned) -> ModelFile:
        """Return the content with the surfaces, where these are remembered."""
        if not self._remember:
            return content
        kept = learned.kept
        return with_memory(content, self._core.completed(), (kept.structure, kept.motion), self._start)

    def _learned(self, model: _core.LearnedModel, *, limits: bool) -> Learned:
        separation = self._settings.wheel_separation
        found = found_limits(self._core, model, separation) if limits else None
        self._limits = found if limits else self._limits
        held_out = held_out_predictions(model, JUDGING_HORIZONS)
        return learned_now(self._core, model, found, held_out, self.sources)

    def save(self) -> bytes:
        """Return all of it as bytes, from which `load` makes a learner that goes on to the same results."""
        facts = {
            "input": self._input,
            "settings": self._settings.model_dump(mode="json"),
            "runs": self._runs,
            "logs": self._logs,
            "wheels": self._wheels,
            "wheel_step": [self._wheel_step.total, self._wheel_step.count, self._wheel_step.last],
            "sideways": {name: [s.most, s.right, s.left] for name, s in self._sideways.items()},
            "positions": self._positions,
            "sources": list(self._sources),
            "gyro_alone": self._gyro_alone,
            "wheelbase": self._wheelbase,
            "remember": self._remember,
            "start": None if self._start is None else self._start.to_yaml(),
        }
        head = json.dumps(facts).encode()
        body = len(head).to_bytes(_LENGTH_BYTES, "little") + head + self._core.save()
        return _core.sealed(body)

    @classmethod
    def load(cls, saved: bytes) -> MotionLearner:
        """Return the learner that was saved, in this process or another, on this machine or another.

        Raises:
            SettingsError: these are not the bytes that this version of slipwise saved.
        """
        check_arguments(MotionLearner.load, locals())
        try:
            body = _core.opened(saved)
            split = _LENGTH_BYTES + int.from_bytes(body[:_LENGTH_BYTES], "little")
            facts = json.loads(body[_LENGTH_BYTES:split])
            core = _core.MotionLearner.load(body[split:])
            begun = _core.MotionLearner(core.settings).save()
            settings = make_settings(facts["settings"], where="saved settings", saved=True)
            learner = cls(
                facts["input"],
                settings,
                coming=Coming(
                    positions=bool(facts["positions"]),
                    gyro_alone=bool(facts.get("gyro_alone")),
                    sources=tuple(str(name) for name in facts.get("sources", [])),
                ),  # whose terms the settings hold already
                remember=bool(facts.get("remember")),
                wheelbase=facts.get("wheelbase"),
            )
            if learner._core.save() != begun:
                raise ValueError("it is of other settings than it says")
            if facts.get("start"):
                learner._start = parse_model(facts["start"], where="saved model")
            learner._wheel_step = WheelStep(*facts.get("wheel_step", ()))
            for name, seen in facts.get("sideways", {}).items():
                learner._sideways[name] = SidewaysSeen(*seen)
            learner._logs = {str(sha256): str(path) for sha256, path in facts.get("logs", {}).items()}
            learner._runs, learner._wheels = [str(run) for run in facts["runs"]], bool(facts["wheels"])
        except (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RuntimeError) as problem:
            raise SettingsError(f"the saved learner cannot be loaded: {problem}") from problem
        learner._core = core
        return learner

    def __reduce__(self) -> tuple[Callable[[bytes], MotionLearner], tuple[bytes]]:
        return MotionLearner.load, (self.save(),)

    def _name_run(self, name: str) -> None:
        """Name the run that begins, in place of the one before where that had no measurement."""
        if self._runs and not np.isfinite(self._core.newest):
            self._runs.pop()
        self._runs.append(name)
        self._wheel_step.restart()

    def _run(self, index: int) -> str:
        return self._runs[index] if index < len(self._runs) else ""
