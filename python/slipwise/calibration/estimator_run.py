# SPDX-License-Identifier: Apache-2.0
"""Estimators that the learner is compared with, as packages beside slipwise add them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from slipwise import plugins
from slipwise.calibration.learner import Posterior, Progress
from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.result import History
from slipwise.calibration.settings import Settings


@dataclass(frozen=True, eq=False)
class EstimatorRun:
    """Causal posteriors on the way, and what is kept in the end."""

    posterior: Callable[[int], Posterior]  # known causally after so many windows, which never decrease
    kept: Callable[[], Posterior]  # learns the rest and returns what goes into a model
    history: Callable[[], History | None]  # where it was recorded
    bases: tuple[str, ...]
    dynamics: bool
    causal: bool  # whether what is kept is the last of the causal posteriors


class RunEstimator(Protocol):
    """How an estimator learns."""

    def __call__(
        self,
        settings: Settings,
        input_name: str,
        windows: WindowSet,
        *,
        record: bool = False,
        progress: Progress | None = None,
    ) -> EstimatorRun:
        """Prepare to learn; nothing is learned yet.

        Args:
            settings: what to learn and how; they name the estimator.
            input_name: "command" or "wheel".
            windows: what counts as learned; posteriors are asked for by counts of them.
            record: keep the history.
            progress: called with the fraction done, 0 to 1, where the history is kept.

        Raises:
            SettingsError: a basis or a term is unknown.
        """
        ...


@dataclass(frozen=True)
class EstimatorInfo:
    """An estimator that a package adds."""

    run: RunEstimator
    off_line: bool  # whether it fits all windows at once


def estimator_info(name: str) -> EstimatorInfo:
    """Return the estimator of this name.

    Raises:
        SlipwiseError: no installed package adds it.
    """
    info: EstimatorInfo = plugins.load(plugins.ESTIMATORS, name)
    return info
