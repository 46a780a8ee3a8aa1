# SPDX-License-Identifier: Apache-2.0
"""Calls every function of the compiled core with one wrong argument after the other; run as a process.

Each call is named on stdout before it is made, so that the last line says which one ended the process.
"""

from __future__ import annotations

import resource
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
from bindings.sound_arguments import owner_of, sound
from bindings.stub_calls import Bound, bound_functions, compiled
from bindings.unusual_objects import other_objects

SECONDS = 20.0  # of the processor's time, until a call counts as hanging
MEMORY = 4 << 30  # bytes

# Arrays of any length are right here, or the lengths are compared where the object is used.
ANY_LENGTH = {
    "VibrationBands.features samples",
    "current_features samples",
    "even_samples values",
    "squared_distances first",
    "squared_distances second",
    "MotionLearner.predict forces",
    "KernelExpert.__init__ weights",
    "KernelExpert.probabilities features",
    "KernelExpert.newness features",
    "TerrainTree.__init__ leaves",
    "TreeExpert.probabilities features",
    "ExpertPool.unknown probability",
    "doubt_of probability",
    "TerrainClassifier.answers vibration",
    "TerrainClassifier.answers current",
    "BayesianRegression.__init__ weight_std",
    "BayesianRegression.predict_rows features",
    "CostmapView.__init__ cells",
    "WheelRecord.__init__ wheels",
    "DynamicsFilter.predict inputs",
    "DynamicsNoise.__init__ psd",
    "ElevationMap.__init__ elevation",
    "Ground.measured rows",
    "Ground.standings poses",
    "LeastSquaresFit.mean_variances features",
    "MotionLearner.predict future",
    "Mppi.step past",
    "NoiseGroup.__init__ residuals",
    "Recording.__init__ attitudes",
    "Recording.__init__ commands",
    "Recording.__init__ forces",
    "Recording.__init__ poses",
    "Recording.__init__ wheels",
    "RegressionExample.__init__ features",
    "StartList.__init__ past",
    "StartList.__init__ starts",
    "WheelLayout.wheels_for twists",
    "actuator_output times",
    "correlated_pairs covariance",
    "distance_field occupied",
    "fit_least_squares design",
    "car_twists commands",
    "rollout_batch commands",
    "sample_futures commands",
    "sample_futures out",
    "thesis_std_coefficients design",
    "steady_covariance times",
    "steady_path times",
    "towed_turns trailers",
}


def target(bound: Bound) -> Callable[..., Any]:
    """Return what is called, on a fresh object where it is a method."""
    if not bound.owner:
        return compiled(bound.name)  # type: ignore[no-any-return]
    kind = compiled(bound.owner)
    if bound.name == "__init__":
        return kind  # type: ignore[no-any-return]
    owner = kind if bound.name == "with_response" else owner_of(bound)
    return getattr(owner, bound.name)  # type: ignore[no-any-return]


def call(bound: Bound, changed: dict[str, Any]) -> Any:
    """Call with sound arguments but for those changed."""
    given = [
        changed[name] if name in changed else sound(bound, name, kind) for name, kind in bound.parameters
    ]
    return target(bound)(*given)


def wrong_lengths(array: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the array with other lengths along each axis, each of them once."""
    for axis in range(array.ndim):
        for length in (0, array.shape[axis] + 1):
            take = np.resize(np.arange(max(array.shape[axis], 1)), length)
            yield f"{length} along axis {axis}", np.take(array, take, axis=axis)
    if array.ndim > 1:
        yield "empty", np.zeros((0,) * array.ndim, array.dtype)
        yield "one row and one column more", np.ones([size + 1 for size in array.shape], array.dtype)


def odd_arrays(array: np.ndarray) -> Iterator[tuple[str, Any]]:
    """Yield arrays of the right shape and odd values or layout, and what is no such array."""
    if array.dtype.kind == "f":
        for value in (np.nan, np.inf, -1.0, 0.0, 1e300, 1e-300):
            yield f"full of {value}", np.full_like(array, value)
            if array.size:
                one = array.copy()
                one.flat[-1] = value
                yield f"{value} at the end", one
    yield "huge", np.ones([100_000, *array.shape[1:]], array.dtype)
    yield "of integers", array.astype(np.int64)
    yield "of texts", array.astype(str)
    yield "a scalar", array.dtype.type(1)
    yield "one axis more", array[None]
    yield "no array", object()
    read_only = array.copy()
    read_only.flags.writeable = False
    yield "read-only", read_only


def odd_values(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield other values of a plain type, or of another type."""
    if isinstance(value, bool):
        yield "2", 2
    elif isinstance(value, float):
        for odd in (np.nan, np.inf, -np.inf, -1.0, 0.0, 1e300, -1e300, 1e-300):
            yield str(odd), odd
    elif isinstance(value, int):
        for odd in (-1, 0, 1 << 31, 1 << 40, (1 << 64) - 1, 1 << 70):
            yield str(odd), odd
    elif isinstance(value, str):
        for text in ("", "\0", "x" * 100_000, "\udc80"):
            yield repr(text[:10]), text
    elif isinstance(value, bytes):
        yield from (("empty", b""), ("cut", value[: len(value) // 2]), ("of zeros", bytes(len(value))))
    elif isinstance(value, list):
        yield from (("empty", []), ("twice", value * 2), ("long", value * 2000), ("of None", [None]))
    else:
        yield from other_objects(type(value).__name__)
    yield "None", None
    yield "an object", object()


def attempt(bound: Bound, parameter: str, name: str, value: Any) -> Exception | None:
    """Make one call; return what it raised."""
    print(f"{bound.title} with {parameter} {name}", flush=True)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        call(bound, {parameter: value})
    except Exception as error:
        return error
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return None


def check_layout(bound: Bound, parameter: str, array: np.ndarray) -> list[str]:
    """Return a fault where a view with gaps in memory gives another result than the same numbers without."""
    gaps = np.repeat(array, 2, axis=-1)[..., ::2]
    print(f"{bound.title} with {parameter} in a view", flush=True)
    try:
        found = call(bound, {parameter: gaps})
    except TypeError:
        return []
    same = call(bound, {parameter: array})
    if isinstance(found, np.ndarray) and not np.array_equal(found, same, equal_nan=True):
        return [f"{bound.title}: a view as {parameter} gives another result"]
    return []


def check(bound: Bound) -> list[str]:
    """Make all calls of one function; return what is wrong."""
    faults: list[str] = []
    for parameter, annotation in bound.parameters:
        value = sound(bound, parameter, annotation)
        if isinstance(value, np.ndarray):
            for name, array in wrong_lengths(value):
                error = attempt(bound, parameter, name, array)
                if error is None and f"{bound.title} {parameter}" not in ANY_LENGTH:
                    faults.append(f"{bound.title} takes {parameter} with {name}")
            for name, odd in odd_arrays(value):
                attempt(bound, parameter, name, odd)
            faults += check_layout(bound, parameter, value)
        else:
            for name, odd in odd_values(value):
                attempt(bound, parameter, name, odd)
    return faults


def main() -> None:
    """Check the functions from the given number on, or all; print the faults after a line of dashes."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    first, last = (int(text) for text in sys.argv[1:3])
    faults = [fault for bound in bound_functions()[first:last] for fault in check(bound)]
    print("-" * 20, *faults, sep="\n")


if __name__ == "__main__":
    main()
