# SPDX-License-Identifier: Apache-2.0
"""The loop of `slipwise live`: samples in, one after the other; odometry, paths, state and the model out."""

from __future__ import annotations

import logging
import math
import threading
import time
from collections import deque
from collections.abc import Callable
from functools import partial

import numpy as np

from slipwise.errors import SlipwiseError
from slipwise.live.giving import Giving
from slipwise.live.node_parts import NodeParts
from slipwise.live.odometry import odometry_of, path_ahead
from slipwise.live.outputs import NoPrediction, Odometry, Output, ParameterNow, Path
from slipwise.live.requests import asked_commands
from slipwise.live.samples import Answer, Override, Pose, Request, RunStart, Sample, SurfaceCue, Unusable
from slipwise.live.status import DrivenPath, Now, parameters_now, status_of

MOST_WAITING = 20_000  # samples; a transport waits beyond them
AT_ONCE = 256  # samples between two looks at the clock
REST = 0.01  # s between two looks for samples
LAST = 1.0  # s of the wall clock for what had come when the node was stopped
WAITED = "samples that still waited when the node was stopped"
ODOMETRY_EVERY = 0.02  # s of stamps
STATUS_EVERY = 0.2  # s of the wall clock
NOTICES_EVERY = 1.0  # s of the wall clock
WORKS_AFTER = 5.0  # s of the wall clock with samples, after which what was loaded is sound
SAVE_EVERY = 60.0  # s of the wall clock: a minute of learning is lost at most
AHEAD = 2.0  # s that the present command is predicted

_log = logging.getLogger(__name__)


class LiveNode:
    """Everything but the transports' callbacks happens in the thread that calls `run`."""

    def __init__(self, parts: NodeParts) -> None:
        self._parts = parts
        self._waiting: deque[Sample] = deque()
        self._takes = False  # what waits; before, it is our own thread that may bring what came earlier
        self._driven = DrivenPath()
        self._stopped = threading.Event()
        self._last_odometry = -math.inf  # s, stamp
        self._odometry: Odometry | None = None
        self._stuck = False
        self._parameters: tuple[ParameterNow, ...] = ()
        self._next = dict.fromkeys(("status", "notices", "save", "works"), 0.0)  # s of the wall clock
        self._unsaved: SlipwiseError | None = None  # why the state was not saved the last time
        self._giving = Giving(parts, self._publish)

    def stop(self) -> None:
        """End the loop; may be called from any thread, or a signal."""
        self._stopped.set()

    @property
    def waiting(self) -> int:
        """How many samples came and are not taken yet."""
        return len(self._waiting)

    def run(self) -> None:
        """Take samples until the transport has no more, or the node is stopped; then save.

        Raises:
            SlipwiseError: the transport cannot be used, or fails; or the state could not be saved at the end.
        """
        parts = self._parts
        self._next["save"] = time.monotonic() + SAVE_EVERY
        self._next["works"] = time.monotonic() + WORKS_AFTER
        try:
            parts.transport.subscribe(self._arrive)
            self._takes = True
            while not self._stopped.is_set():
                if not self._take_some() and parts.transport.finished and not self._waiting:
                    break
                self._survive("the state of the node", self._tick)
        finally:
            parts.transport.close()
            self._finish()
        if self._unsaved is not None:
            raise self._unsaved

    def _survive(self, what: str, step: Callable[[], object]) -> object:
        """Do a step; nothing that a sample, a request or an output causes ends the node.

        It is counted, and said once of each kind.
        """
        try:
            return step()
        except Exception as problem:
            said, kind = self._parts.said, f"{what}: {type(problem).__name__}"
            said.count(f"{what} failed")
            said.once(self._parts.intake.newest, kind, f"{what} failed: {str(problem) or kind}")
            _log.debug("%s failed", what, exc_info=True)
            return None

    def _arrive(self, sample: Sample) -> None:
        """Called from the transport's threads."""
        while len(self._waiting) >= MOST_WAITING and self._takes and not self._stopped.is_set():
            time.sleep(REST)
        self._waiting.append(sample)

    def ask(self, request: Request) -> None:
        """Ask for something; may be called from any thread."""
        self._waiting.append(request)

    def _take_some(self) -> bool:
        """Take what waits, up to a number; return whether there was anything."""
        if not self._waiting:
            if not self._survive("the search for moves", self._look_for_moves):
                time.sleep(REST)  # a lock for each sample would cost more than what is done with it
            return False
        for _ in range(min(len(self._waiting), AT_ONCE)):
            sample = self._waiting.popleft()
            self._survive(_name_of(sample), partial(self._take, sample))
        return True

    def _look_for_moves(self, *, whole: bool = False) -> bool:
        """Look for moves worth driving, for a millisecond or so; return whether there was something to do."""
        parts = self._parts
        model = parts.learning.model
        if model is None or not parts.adviser.due(model, time.monotonic()):
            return False
        found = parts.adviser.advance(parts.intake.newest, model, self._parameters, whole=whole)
        if found is not None:
            self._publish(found)
        return True

    def _take(self, sample: Sample) -> None:
        parts = self._parts
        if isinstance(sample, Request):
            self._answer(sample)
            return
        if isinstance(sample, Unusable):
            parts.said.count(sample.reason, number=sample.number)
            parts.said.once(parts.intake.newest, sample.kind, sample.text)
            return
        if isinstance(sample, SurfaceCue):
            parts.intake.take_cue(sample)
            return
        if isinstance(sample, RunStart):
            if sample.drive is None:
                parts.intake.start_run(sample.name)
            else:
                parts.intake.start_drive(sample.name, sample.drive)
            return
        parts.intake.take(sample)
        t = parts.intake.newest
        if isinstance(sample, Pose):
            self._driven.take(sample.x, sample.y, sample.yaw)
        if parts.intake.teaches(sample):
            if parts.learning.take(parts.intake.events()):
                self._publish_surface(t)
            self._judge(t)
            self._watch_motion(t)
        if not isinstance(sample, Override):
            self._publish_odometry(t)

    def _judge(self, t: float, *, last: bool = False) -> None:
        parts = self._parts
        parts.learning.learner.know_clocks(compared=parts.transport.clocks_compared)
        if parts.learning.judge(t, last=last):
            self._giving.publish_model(t, stuck=self._stuck)
            self._parameters = parameters_now(parts.learning, parts.applied)

    def _publish_odometry(self, t: float) -> None:
        """Whenever something newer is known, at a bounded rate."""
        if t < self._last_odometry:
            self._last_odometry = -math.inf
        if t < self._last_odometry + ODOMETRY_EVERY:
            return
        self._last_odometry = t
        self._odometry = odometry_of(self._parts.learning.learner, self._parts.intake.newest_pose)
        if self._odometry is not None:
            self._publish(self._odometry)

    def _watch_motion(self, t: float) -> None:
        parts = self._parts
        monitor = parts.learning.learner.motion_monitor()
        if monitor.stuck and not self._stuck:
            parts.said.begins(t, "stuck", "the robot is stuck: it does not move as the model predicts")
        elif self._stuck and not monitor.stuck:
            parts.said.ends(t, "stuck", "the robot moves again")
        self._stuck = monitor.stuck

    def _publish_surface(self, t: float) -> None:
        surface = self._parts.intake.surfaces.learned(t)
        if surface is not None:
            self._publish(surface)

    def _answer(self, request: Request) -> None:
        answer = self._answer_to(request)
        said, t = self._parts.said, self._parts.intake.newest
        if not answer.success and request.kind == "predict":
            said.once(t, "no prediction", answer.message)
        elif not answer.success:
            said.note(t, answer.message)
        if request.answer is not None:
            request.answer(answer)
        elif not answer.success and request.kind == "predict":
            self._publish(NoPrediction(answer.message))

    def _answer_to(self, request: Request) -> Answer:
        parts, t = self._parts, self._parts.intake.newest
        if request.kind == "apply":
            answer = self._giving.apply_now(t)
            self._parameters = parameters_now(parts.learning, parts.applied)
            return answer
        if request.kind == "save":
            self.save()
            if parts.cache is None:
                return Answer(False, "nothing is saved: there is no cache")
            return Answer(self._unsaved is None, str(self._unsaved or f"saved in {parts.cache.state}"))
        if request.kind in ("freeze", "resume"):
            parts.gates.frozen = request.kind == "freeze"
            return Answer(True, "learning is frozen" if parts.gates.frozen else "learning goes on")
        return self._predict(request.content)

    def _predict(self, content: str) -> Answer:
        try:
            if self._odometry is None:
                raise ValueError("no pose was measured yet")
            learner = self._parts.learning.learner
            names, newest = learner.axes.names, self._parts.intake.newest
            rows, horizon = asked_commands(content, names, newest=newest, horizon=AHEAD)
            path = path_ahead(learner, self._odometry, rows, horizon=horizon, asked=True)
        except Exception as problem:  # the text comes from outside
            self._parts.said.count("a prediction that cannot be made")
            return Answer(False, f"a prediction was asked for that cannot be made: {problem}")
        self._publish(path)
        return Answer(True, "", path)

    def _tick(self) -> None:
        now = time.monotonic()
        if now >= self._next["notices"]:
            self._next["notices"] = now + NOTICES_EVERY
            self._take_notices()
        for note in self._parts.said.take_new():
            self._publish(note)
        if now >= self._next["status"]:
            self._next["status"] = now + STATUS_EVERY
            self._publish_status()
        if now >= self._next["works"] and math.isfinite(self._parts.intake.newest):
            self._next["works"] = math.inf
            if self._parts.cache is not None:
                self._parts.cache.works()
        if now >= self._next["save"]:
            self._next["save"] = now + SAVE_EVERY
            self.save()

    def _take_notices(self) -> None:
        texts = self._parts.transport.notices()
        for watcher in self._parts.watchers:
            texts += watcher.notices()
        for text in texts:
            self._parts.said.note(self._parts.intake.newest, text, error=True)

    def _publish_status(self) -> None:
        parts = self._parts
        predicted = self._present_path()
        if predicted is not None:
            self._publish(predicted)
        waits, surface = parts.gates.waits(parts.intake.newest), parts.intake.surfaces.now
        now = Now(self._odometry, predicted, self._stuck, waits, surface)
        shown = (parts.learning, parts.intake, parts.said)
        self._publish(status_of(parts.who, shown, self._parameters, self._driven, now))

    def _present_path(self) -> Path | None:
        newest = self._parts.intake.newest_input
        if newest is None or self._odometry is None:
            return None
        learner = self._parts.learning.learner
        command = learner.axes.of_twist((newest.v, newest.vy, newest.omega))
        held = np.array([[self._parts.intake.newest, *command]])
        try:
            return path_ahead(learner, self._odometry, held, horizon=AHEAD)
        except SlipwiseError:
            return None  # nothing was measured in this run yet

    def _publish(self, output: Output) -> None:
        self._parts.transport.publish(output)
        for watcher in self._parts.watchers:
            watcher.take(output)

    def save(self) -> None:
        """Save the state; a disk that is full is said once, and tried again."""
        parts = self._parts
        if parts.cache is None:
            return
        t = parts.intake.newest
        try:
            parts.cache.save(parts.learning.learner, parts.learning.valid)
        except SlipwiseError as problem:
            self._unsaved = problem
            parts.said.begins(t, "cache", f"the state cannot be saved: {problem}", error=True)
            parts.said.count("a state that could not be saved")
        else:
            self._unsaved = None
            parts.said.ends(t, "cache", "the state can be saved again")

    def _finish(self) -> None:
        parts, until = self._parts, time.monotonic() + LAST
        while self._waiting and time.monotonic() < until:
            self._take_some()
        if self._waiting:
            parts.said.count(WAITED, number=len(self._waiting))
        t = parts.intake.newest
        self._survive("the last segment", lambda: parts.learning.take(parts.intake.events()))
        self._survive("the last judgement", lambda: self._judge(t, last=True))
        self._survive("the search for moves", lambda: self._look_for_moves(whole=True))
        if parts.handover is not None:
            self._survive("the handover", partial(parts.handover.finish, t))
        self._survive("the state of the node", self.save)
        self._survive("the state of the node", self._say_all)
        for watcher in parts.watchers:
            watcher.close()
        if parts.cache is not None:
            parts.cache.close()

    def _say_all(self) -> None:
        self._take_notices()
        self._publish_status()
        for note in self._parts.said.take_new():
            self._publish(note)


def _name_of(sample: Sample) -> str:
    """What it is, for counts."""
    return (
        f"a request ({sample.kind})" if isinstance(sample, Request) else f"a sample ({type(sample).__name__})"
    )
