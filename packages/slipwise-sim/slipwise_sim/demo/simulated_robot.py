# SPDX-License-Identifier: Apache-2.0
"""The robot of `slipwise live --demo`: it drives a slalom by the newest model that the node gave it."""

from __future__ import annotations

import threading
import time

from slipwise.errors import ModelError, SettingsError, SlipwiseError
from slipwise.live.outputs import ModelText, Output
from slipwise.live.transport import OnSample, Transport
from slipwise.models import parse_model
from slipwise.planning import learned_motions
from slipwise_sim.demo.closed_loop import vendor
from slipwise_sim.demo.slalom_course import SlalomCourse, slalom_course
from slipwise_sim.demo.slalom_drive import SlalomDrive

LATE = 1.0  # [s] behind its clock, from which on the robot says that it does not keep up


class SimulatedRobot(Transport):
    """A transport whose other end is a simulated robot with an MPPI controller.

    Until a model comes whose verdict is good, the controller drives by a vendor's constants.

    Args:
        seed: of the course, of the measurement noise, and of the controller's samples.
        rate: times real time.
        course: where to drive; by default the slalom across three floors that the seed draws.

    Raises:
        SettingsError: the rate is not positive, or the seed is negative.
    """

    def __init__(self, *, seed: int = 1, rate: float = 1.0, course: SlalomCourse | None = None) -> None:
        if not 0.0 < rate < float("inf"):
            raise SettingsError(
                f"the rate is {rate:g}", where="--rate", advice="such as 1, or 10 for a fast look"
            )
        self.course = slalom_course(seed) if course is None else course
        self._seed, self._rate = seed, rate
        self._stopped, self._done = threading.Event(), threading.Event()
        self._lock = threading.Lock()
        self._text: str | None = None  # a model that the controller has not taken yet
        self._said: list[str] = []
        self._thread: threading.Thread | None = None

    def subscribe(self, on_sample: OnSample) -> None:
        """Put the robot at the start, and drive off.

        Raises:
            SlipwiseError: MuJoCo is not installed.
        """
        drive = SlalomDrive(self.course, vendor(), seed=self._seed)
        self._say(f"on {self.course.floors[drive.floor].name}, driving by the vendor's constants")
        self._thread = threading.Thread(
            target=self._run, args=(drive, on_sample), name="simulated robot", daemon=True
        )
        self._thread.start()

    def publish(self, output: Output) -> None:
        """Keep the newest model for the controller; nothing else is listened to."""
        if isinstance(output, ModelText):
            with self._lock:
                self._text = output.text

    def notices(self) -> list[str]:
        """Return what happened since the last call: floors, models taken, the end."""
        with self._lock:
            said, self._said = self._said, []
        return said

    @property
    def finished(self) -> bool:
        """Whether the course is driven."""
        return self._done.is_set()

    @property
    def wheels(self) -> bool:
        """They come beside commands."""
        return True

    def close(self) -> None:
        """Stop where it is."""
        self._stopped.set()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(timeout=2.0)

    def _run(self, drive: SlalomDrive, on_sample: OnSample) -> None:
        try:
            self._drive(drive, on_sample)
        except SlipwiseError as problem:
            self._say(f"the simulated robot stopped: {problem}")
        finally:
            self._done.set()

    def _drive(self, drive: SlalomDrive, on_sample: OnSample) -> None:
        begin, floor, late, learned = time.monotonic(), drive.floor, False, False
        while not (drive.finished or self._stopped.is_set()):
            taken = self._take_model(drive)
            if taken and not learned:
                self._say(f"{drive.t:.1f} s: driving by the learned model")
            learned |= taken
            for sample in drive.advance():
                on_sample(sample)
            if drive.floor != floor:
                floor = drive.floor
                self._say(f"{drive.t:.1f} s: the floor is {self.course.floors[floor].name} now")
            left = begin + drive.t / self._rate - time.monotonic()
            if left < -LATE and not late:
                late = True
                self._say(f"the simulation does not keep up with {self._rate:g} times real time here")
            self._stopped.wait(max(0.0, left))
        if drive.finished:
            error = abs(drive.trace.left).mean()
            self._say(f"{drive.t:.1f} s: at the end; {error:.3f} m beside the path on average")

    def _take_model(self, drive: SlalomDrive) -> bool:
        """Let the controller drive by the newest model, where one came and its verdict is good."""
        with self._lock:
            text, self._text = self._text, None
        if text is None:
            return False
        try:
            model = parse_model(text, where="the node's model")
        except ModelError as problem:
            self._say(f"{drive.t:.1f} s: a model was not taken: {problem}")
            return False
        if not model.content.verdict.good:
            return False
        drive.adopt(learned_motions(model))
        return True

    def _say(self, text: str) -> None:
        with self._lock:
            self._said.append(text)
