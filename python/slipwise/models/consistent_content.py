# SPDX-License-Identifier: Apache-2.0
"""Whether the parts of a model's content fit each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import ModelError
from slipwise.models.parameter_table import VECTOR

if TYPE_CHECKING:
    from slipwise.models.model import Model

LONGEST_CHAIN = 1000.0  # s; no drive answers its commands later


def check_content(model: Model) -> None:
    """Refuse content that contradicts itself, or that this version would have to leave out.

    Raises:
        ModelError: a part does not fit, with its name.
    """
    newer = _newer(model)
    if newer:
        raise ModelError(
            f"the model has {', '.join(newer[:3])}, which this slipwise does not know how to use",
            advice="use the slipwise version that wrote it",
        )
    for fault in _faults(model):
        raise ModelError(fault, advice="calibrate again, or restore the file")


def _faults(model: Model) -> Iterator[str]:
    rows, known = model.content.parameters, model.motion.parameters
    names = [info.name for info in known]
    stated = [row.name for row in rows if row.stage in VECTOR]
    if names != stated or stated != [row.name for row in rows[: len(names)]]:
        yield f"the parameters are {', '.join(stated)} where slip and actuator have {', '.join(names)}"
    for info, row in zip(known, rows, strict=False):
        if row.unit != info.unit:
            yield f"the unit of {info.name} is {info.unit}, not {row.unit[:40]!r}"
    seconds = np.exp([min(row.value, 700.0) for row in rows if row.name.startswith("log_")])
    delays = np.abs([row.value for row in rows if row.name.startswith("delay_") or row.name.endswith("lag")])
    if (np.concatenate((seconds, delays)) > LONGEST_CHAIN).any():
        yield f"parameters: a lag or delay is longer than {LONGEST_CHAIN:g} s"
    for surface in model.content.surfaces:
        bases = surface.memory.bases.values() if surface.memory is not None else ()
        for each in (surface, *bases):
            if each.slip and not _is_covariance(np.array(each.covariance, dtype=np.float64)):
                yield f"the covariance of the surface {surface.name!r} is not symmetric and positive"
    if not _is_covariance(model.table.covariance):
        yield "covariance: not symmetric and positive"
    stds = [row.std for row in rows]
    if not np.allclose(np.square(stds), np.diag(model.table.covariance), rtol=1e-6, atol=0.0):
        yield "parameters: a standard deviation is not the root of its variance in the covariance"
    try:
        _ = model.limits_section, model.car
    except ValueError as problem:
        yield f"parameters: {problem}"


def _newer(model: Model) -> list[str]:
    """What the schema has room for and this version does not use yet: it must not be left out in silence."""
    content, rows = model.content, model.content.parameters
    found = [name for name in ("branches", "message") if getattr(content, name)]
    found += [f"{row.name} of {row.branch}" for row in rows if row.branch]
    found += [f"{row.name} of {row.sensor}" for row in rows if row.sensor and row.stage != "mount"]
    return [*found, *(f"{row.name} of {row.input}s" for row in rows if row.input is not None)]


def _is_covariance(matrix: NDArray[np.float64]) -> bool:
    """Whether the matrix, scaled to correlations, is symmetric without negative eigenvalues."""
    variances = np.diag(matrix)
    if (variances < 0.0).any():
        return False
    stds = np.sqrt(variances)
    known = stds > 0.0
    if matrix[~known].any() or matrix[:, ~known].any():
        return False
    correlation = matrix[np.ix_(known, known)] / stds[known] / stds[known, None]
    if not known.any():
        return True
    if (np.abs(correlation) > 1.0 + 1e-6).any() or not np.allclose(correlation, correlation.T, atol=1e-6):
        return False
    return bool(np.linalg.eigvalsh(correlation).min() >= -1e-6)
