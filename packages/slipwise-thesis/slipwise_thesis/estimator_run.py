# SPDX-License-Identifier: Apache-2.0
"""A log learned by one estimator, window by window, and the estimators as slipwise finds them."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.estimator_run import EstimatorInfo, EstimatorRun, estimator_info
from slipwise.calibration.learner import Posterior, Progress
from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.result import History
from slipwise.calibration.settings import Settings
from slipwise.segments import wheelbase_of
from slipwise_thesis.estimators import estimator_learner, estimator_motion, fed_windows


def run_estimator(
    settings: Settings,
    input_name: str,
    windows: WindowSet,
    *,
    record: bool = False,
    progress: Progress | None = None,
) -> EstimatorRun:
    """Prepare to learn; nothing is learned yet.

    Args:
        settings: what to learn and how.
        input_name: "command" or "wheel".
        windows: what counts as learned; posteriors are asked for by counts of them.
        record: keep the history.
        progress: called with the fraction done, 0 to 1, where the history is kept.

    Raises:
        SettingsError: a basis or a term is unknown.
    """
    name = settings.estimator
    motion = estimator_motion(name, settings, input_name, wheelbase_of([run.run for run in windows.drive]))
    learner, fed = estimator_learner(name, motion, settings), fed_windows(name, settings, windows)
    causal = not estimator_info(name).off_line
    history = _empty_history(fed, motion)

    def see(i: int, update: _core.IekfUpdate, posterior: Posterior) -> None:
        history.mean[i], history.std[i] = posterior.mean, np.sqrt(np.diag(posterior.covariance))
        history.nis[i], history.weight[i] = update.nis, update.weight
        if progress is not None and i % 50 == 0:
            progress((i + 1) / len(fed))

    passing = CausalPass(learner, fed, see if record else None, pace=windows)

    def kept() -> Posterior:
        passing.finish()
        return learner.fitted()

    def recorded() -> History | None:
        passing.finish()
        return history if record and causal else None

    return EstimatorRun(passing.posterior, kept, recorded, (motion.basis.name,), motion.dynamics, causal)


def _empty_history(windows: WindowSet, motion: _core.MotionModel) -> History:
    names = tuple(info.name for info in motion.parameters)
    count = len(windows)
    return History(
        run=np.array([windows.drive[p].index for p in windows.position], dtype=np.int64),
        t=windows.end,
        names=names,
        mean=np.zeros((count, len(names))),
        std=np.zeros((count, len(names))),
        nis=np.zeros(count),
        weight=np.zeros(count),
        bases=(motion.basis.name,),
        basis_weight=np.ones((count, 1)),
        change=np.zeros(count),
        alarm=np.zeros(count, dtype=np.bool_),
    )


ON_LINE = EstimatorInfo(run_estimator, off_line=False)
OFF_LINE = EstimatorInfo(run_estimator, off_line=True)
