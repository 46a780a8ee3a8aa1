# SPDX-License-Identifier: Apache-2.0
"""The surface that is driven on, as the learner remembers it, and labels from others."""

from __future__ import annotations

from datetime import UTC, datetime

from slipwise.calibration.learned_sequence import SurfaceChange, SurfaceSummary
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.live.diagnostics import surface_name
from slipwise.live.outputs import SurfaceNow
from slipwise.live.said import Said
from slipwise.live.samples import DriveStart, SurfaceCue
from slipwise.models.schema import LONGEST_NAME


class SurfaceWatch:
    """Passes labels and cues on to the learner, and says which surface the robot is on.

    A label that is repeated says nothing new: a classifier may publish it many times a second.

    Args:
        learner: that learns from the samples; it may remember no surfaces.
        said: where news are said.
    """

    def __init__(self, learner: MotionLearner, said: Said) -> None:
        self._learner, self._said = learner, said
        self._label = ""
        self._remembered: tuple[SurfaceSummary, ...] = ()
        self._labels = (0.0, 0.0)
        self.now: SurfaceNow | None = None
        self.look_again()

    def start_run(self, run: str) -> None:
        """Begin a run on the surface of before; a label counts as new again."""
        self._label = ""
        self._learner.start_run(run)

    def start_drive(self, run: str, drive: DriveStart) -> None:
        """Begin a drive: any surface may be under the robot, the one of the label above all."""
        if not self._learner.remembers:
            self.start_run(run)
            return
        self._label = drive.label
        self._learner.start_drive(run, label=drive.label, date=drive.date)

    def take(self, cue: SurfaceCue, t: float) -> None:
        """Take a label, or that something changed, at the stamp of the newest sample [s]."""
        label = cue.label.strip()[:LONGEST_NAME]
        if cue.label and not label:
            self._said.count("a label without a name")
        elif label and not self._learner.remembers:
            self._said.begins(t, "label", "labels are ignored: the node runs without --memory")
        elif not label:
            self._label = ""
            self._said.count("cues that the surface changes")
            self._learner.cue_surface()
        elif label != self._label:
            self._label = label
            self._learner.cue_surface(label)

    def look_again(self) -> None:
        """Look what is remembered; that takes a copy of the learner, so it is done now and then."""
        if self._learner.remembers:
            self._remembered = self._learner.surfaces()
            self._labels = self._learner.label_counts()

    def learned(self, t: float) -> SurfaceNow | None:
        """Return which surface it is, after something was learned; None where none are remembered."""
        if not self._learner.remembers:
            return None
        changes = self._learner.surface_changes()
        for change in changes:
            self._say(t, change)
        if changes:
            self.look_again()
        probable = sorted(self._learner.probable_surfaces(), key=lambda each: -each[1])
        name, probability = probable[0]
        self.now = SurfaceNow(t, name, probability, tuple(probable), self._remembered, self._labels)
        return self.now

    def _say(self, t: float, change: SurfaceChange) -> None:
        name = surface_name(change.name)
        match change.what:
            case "recalled":
                self._said.note(t, f"the surface is {name}, as before (probability {change.probability:.3f})")
            case "new" if not change.name:
                self._said.note(t, "the surface is a new one")
            case "merged":
                self._said.note(t, f"{name} and {change.other} are one surface: they cannot be distinguished")
            case "dropped":
                self._said.note(t, f"{name} is dropped: too many surfaces")


def today() -> str:
    """Return the day, UTC, for the table of surfaces."""
    return datetime.now(UTC).date().isoformat()
