# SPDX-License-Identifier: Apache-2.0
"""The node's memory between two starts: what was learned, keyed by whose it is, whole or not at all."""

from __future__ import annotations

import contextlib
import fcntl
import json
import re
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from typing import IO

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.core_settings import wheelbase_of
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.errors import OutputError, SettingsError
from slipwise.files import output_errors, read_whole, write_text_whole, write_whole
from slipwise.logs.options import LogOptions
from slipwise.models import SCHEMA_VERSION, Model, load_model

MOST_BYTES = 1 << 30
MOST_STARTS = 2  # that one state may end
_LENGTH_BYTES = 8  # of what stands before the learner's bytes
_NUMBERS = (
    "command_scale", "wheel_scale", "wheel_radius", "wheel_separation", "pose_yaw_offset",
    "pose_clock_offset", "command_timeout",
)  # fmt: skip # options of reading by which the same robot drives otherwise
_AS_IT_IS = LogOptions()
_UNFIT = re.compile(r"[^A-Za-z0-9._-]+")


@dataclass(frozen=True)
class CacheKey:
    """Whose memory it is: another robot's, or one of other settings, is never used."""

    vehicle: str
    input: str
    basis: str
    schema: int
    settings: str  # hash of the settings that change the learned model

    @classmethod
    def of(cls, vehicle: str, input_name: str, settings: Settings, read: LogOptions = _AS_IT_IS) -> CacheKey:
        """Return the key of a vehicle that learns from an input with settings, `read` so."""
        text = json.dumps(settings.model_dump(mode="json", exclude={"log"}), sort_keys=True)
        text += "with a memory of surfaces" if settings.live.memory else ""
        text += "".join(f" source {name}" for name in settings.live.sources)
        wheelbase = wheelbase_of(settings)
        text += "" if wheelbase is None else f" steers with a wheelbase of {wheelbase!r} m"
        text += _read_as(read)
        digest = sha256(text.encode()).hexdigest()[:16]
        return cls(vehicle, input_name, settings.basis, SCHEMA_VERSION, digest)


def _read_as(read: LogOptions) -> str:
    """Say by which factors, sizes and offsets numbers are read; empty where they are taken as they are."""
    wheels = None if read.wheels is None else read.wheels.model_dump(mode="json")
    said = {name: getattr(read, name) for name in _NUMBERS} | {"wheels": wheels}
    changed = {name: value for name, value in said.items() if value != getattr(_AS_IT_IS, name)}
    return json.dumps(changed, sort_keys=True) if changed else ""


@dataclass(frozen=True)
class Remembered:
    """What was found in a cache."""

    learner: MotionLearner | None
    valid: Model | None  # the last model that was valid
    said: str  # what happened, for the user


class Cache:
    """A folder with one file of state and the last valid model for each vehicle and input.

    One node at a time has it, until `close` or the end of the process. A state that ended two starts is not
    tried a third time: a start is over once the node works, saved something or ended in order.

    Raises:
        SettingsError: the vehicle has no name that a file can bear.
    """

    def __init__(self, folder: Path, key: CacheKey) -> None:
        vehicle = _UNFIT.sub("-", key.vehicle).strip("-.")
        if not vehicle:
            raise SettingsError(
                f"the vehicle's name is {key.vehicle!r}", advice="give --name one with a letter or digit"
            )
        stem = f"{vehicle}-{key.input}"
        self._key = key
        self.state = folder / f"{stem}.state"
        self.model = folder / f"{stem}.yaml"
        self._starts = folder / f"{stem}.starts"
        self._lock = folder / f"{stem}.lock"
        self._held: IO[bytes] | None = None  # the lock file

    def save(self, learner: MotionLearner, valid: Model | None) -> None:
        """Write the state, and the last valid model as a file of its own that any tool reads.

        Raises:
            OutputError: the disk is full, or the folder cannot be written to.
            SettingsError: it cannot be judged once it is loaded: the next start would end there.
        """
        saved = learner.save()
        try:
            _check_judged(MotionLearner.load(saved))
        except Exception as problem:  # whatever it is, the next start would meet it too
            raise SettingsError(f"it cannot be judged: {problem}", where=str(self.state)) from problem
        if valid is not None:
            write_text_whole(self.model, valid.to_yaml())
        else:  # it was withdrawn, or there was none
            with output_errors(self.model):
                self.model.unlink(missing_ok=True)
        head = json.dumps({"key": asdict(self._key), "valid": valid is not None}).encode()
        body = _core.sealed(len(head).to_bytes(_LENGTH_BYTES, "little") + head + saved)
        write_whole(self.state, lambda place: place.write_bytes(body))
        self.works()

    def load(self) -> Remembered:
        """Return what is remembered; what cannot be used is set aside, and said, never raised.

        Raises:
            OutputError: what is unreadable cannot be set aside, or another node has this cache.
        """
        self._hold()
        if not self.state.exists():
            return Remembered(None, None, "")
        try:
            if self._count_start() > MOST_STARTS:
                return Remembered(
                    None, None, self._set_aside(f"the cache ended the last {MOST_STARTS} starts")
                )
            body = _core.opened(read_whole(self.state, most=MOST_BYTES, error=SettingsError))
            split = _LENGTH_BYTES + int.from_bytes(body[:_LENGTH_BYTES], "little")
            head = json.loads(body[_LENGTH_BYTES:split])
            other = self._difference(head["key"])
            if other:
                return Remembered(None, None, self._set_aside(f"the cache is of another {other}"))
            learner = MotionLearner.load(body[split:])
            _check_judged(learner)
            valid = load_model(self.model) if head["valid"] else None
        except OutputError:
            raise
        except Exception as problem:  # whatever it is, learning starts from nothing
            return Remembered(None, None, self._set_aside(f"the cache cannot be read: {problem}"))
        return Remembered(learner, valid, f"goes on from {self.state}")

    def forget(self) -> Remembered:
        """Set aside what is remembered.

        Raises:
            OutputError: it cannot be set aside, or another node has this cache.
        """
        self._hold()
        there = self.state.exists()
        return Remembered(None, None, self._set_aside("the cache is not wanted any more") if there else "")

    def works(self) -> None:
        """The node works with what was loaded: this start is over."""
        with contextlib.suppress(OSError):
            self._starts.unlink(missing_ok=True)

    def close(self) -> None:
        """Let another node have it: this one ended in order."""
        if self._held is not None:
            self.works()
            self._held.close()
            self._held = None

    def _hold(self) -> None:
        """Lock the cache; the system lifts the lock when the process ends, however it does.

        Raises:
            OutputError: another node has it.
        """
        if self._held is not None:
            return
        try:
            self._lock.parent.mkdir(parents=True, exist_ok=True)
            held = self._lock.open("ab")
        except OSError:
            return  # nothing can be written there: the first save says so, and the node learns meanwhile
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as problem:
            held.close()
            raise OutputError(
                "another node has this cache",
                where=str(self.state),
                advice="give each robot its own --name, or stop that node",
            ) from problem
        except OSError:
            pass  # a file system without locks gives none
        self._held = held

    def _count_start(self) -> int:
        """Return how often this state was started with, this time included, and nothing was saved."""
        try:
            starts = int(self._starts.read_text(encoding="ascii")) + 1
        except (OSError, ValueError):
            starts = 1
        with contextlib.suppress(OutputError):  # a full disk stops no start
            write_text_whole(self._starts, f"{starts}\n")
        return starts

    def _difference(self, found: dict[str, object]) -> str:
        mine = asdict(self._key)
        names = {"schema": "version of slipwise", "settings": "set of settings"}
        return " and ".join(names.get(name, name) for name in mine if found.get(name) != mine[name])

    def _set_aside(self, why: str) -> str:
        aside = self.state.with_name(self.state.name + ".set-aside")
        with output_errors(aside):
            self.state.replace(aside)
            with contextlib.suppress(FileNotFoundError):
                self.model.replace(self.model.with_name(self.model.name + ".set-aside"))
            self._starts.unlink(missing_ok=True)
        return f"{why}; it was moved to {aside}, learning starts from nothing"


def _check_judged(learner: MotionLearner) -> None:
    """Raise whatever a judgement of what was learned raises."""
    if learner.learned:
        learner.judged_model(limits=False)
