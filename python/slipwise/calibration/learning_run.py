# SPDX-License-Identifier: Apache-2.0
"""A log being learned as the settings say: by an average of bases, or by one estimator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.estimators import estimator_learner, estimator_motion, fed_windows
from slipwise.calibration.history_recorder import HistoryRecorder
from slipwise.calibration.learner import Belief, Progress, make_learner
from slipwise.calibration.result import History
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.stamp_spacing import StampSpacing
from slipwise.calibration.start_pass import StartPass
from slipwise.calibration.structure_choice import StructureChoice, learning_pass


@dataclass(frozen=True, eq=False)
class LearningRun:
    """Causal beliefs on the way, and what is kept in the end."""

    belief: Callable[[int], Belief]  # known causally after so many windows; their number never decreases
    kept: Callable[[], Belief]  # learns what is left and returns what goes into a model
    parameters: Callable[[], Belief]  # the same; of the next best where the baseline is kept, which has none
    history: Callable[[], History | None]  # of what is kept, where it was recorded
    limits: Callable[[], _core.LimitSearch | None]  # what the last search for limits of the drive found
    bases: tuple[str, ...]
    dynamics: bool
    causal: bool  # whether what is kept is the last of the causal beliefs


def start_learning(
    settings: Settings,
    input_name: str,
    windows: WindowSet,
    *,
    record: bool = False,
    progress: Progress | None = None,
) -> LearningRun:
    """Prepare to learn; nothing is learned yet.

    Args:
        settings: what to learn and how.
        input_name: "command" or "wheel".
        windows: what counts as learned; beliefs are asked for by counts of them.
        record: keep the history.
        progress: called with the share done, 0 to 1, where the history is kept.

    Raises:
        SettingsError: a basis or a term is unknown.
    """
    make = _averaging if settings.estimator == AVERAGE else _estimating
    return make(settings, input_name, windows, progress, record=record)


def _averaging(
    settings: Settings, input_name: str, windows: WindowSet, progress: Progress | None, *, record: bool
) -> LearningRun:
    learner = make_learner(settings, input_name)
    bases = tuple(basis.name for basis in learner.bases)
    recorder = HistoryRecorder(windows, bases, progress) if record else None
    passing = learning_pass(learner, windows, recorder)
    of_slip = passing.slip_belief if isinstance(passing, StructureChoice) else None
    belief = StartPass(passing.belief, windows, settings, of_slip=of_slip).belief

    def history() -> History | None:
        return None if recorder is None else recorder.history(passing.finish())

    def limits() -> _core.LimitSearch | None:
        return passing.limits if isinstance(passing, StructureChoice) else None

    stamps = StampSpacing(windows)

    def kept() -> Belief:
        return stamps.supported(belief(len(windows)), len(windows))

    def parameters() -> Belief:
        return stamps.supported((of_slip or passing.belief)(len(windows)), len(windows))

    return LearningRun(belief, kept, parameters, history, limits, bases, learner.dynamics, causal=True)


def _estimating(
    settings: Settings, input_name: str, windows: WindowSet, progress: Progress | None, *, record: bool
) -> LearningRun:
    name = settings.estimator
    motion = estimator_motion(name, settings, input_name)
    learner, fed = estimator_learner(name, motion, settings), fed_windows(name, settings, windows)
    bases, causal = (motion.basis.name,), not _core.fits_all_segments(name)
    recorder = HistoryRecorder(fed, bases, progress) if record else None

    def see(i: int, update: _core.IekfUpdate, belief: Belief) -> None:
        if recorder is not None:
            recorder.record(i, update.nis, update.weight, belief)

    passing = CausalPass(learner, fed, see if record else None, pace=windows)

    def kept() -> Belief:
        passing.finish()
        return StampSpacing(windows).supported(learner.fitted(), len(windows))

    def history() -> History | None:
        return recorder.history(passing.finish()) if recorder is not None and causal else None

    return LearningRun(passing.belief, kept, kept, history, lambda: None, bases, motion.dynamics, causal)
