# SPDX-License-Identifier: Apache-2.0
"""Says before the work which optional library it lacks."""

from __future__ import annotations

from importlib.util import find_spec

from slipwise.errors import SlipwiseError

_LIBRARIES = {"slipwise_sim": "simulation", "sklearn": "Gaussian processes"}


def refuse_missing_extras() -> None:
    """Raise where a library that the reproduction needs is not installed.

    Raises:
        SlipwiseError: one is missing.
    """
    for library, purpose in _LIBRARIES.items():
        if find_spec(library) is None:
            raise SlipwiseError(
                f"the reproduction needs {library} for {purpose}, which is not installed",
                advice="in a clone of slipwise: make all",
            )
