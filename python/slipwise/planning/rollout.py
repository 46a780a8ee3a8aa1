# SPDX-License-Identifier: Apache-2.0
"""Rolling out many command sequences through a learned model at once."""

from __future__ import annotations

import functools
from collections.abc import Collection
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from slipwise import _core
from slipwise.argument_types import check_arguments
from slipwise.errors import SettingsError
from slipwise.models.axes import axes_of, drive_axes
from slipwise.models.model import Model
from slipwise.models.seen_speeds import warn_of_unseen_speeds
from slipwise.planning.costmap import Costmap
from slipwise.planning.start import Start
from slipwise.planning.throttle import behind_curves, curve_covariance
from slipwise.prediction import student_at, students_at
from slipwise.terrain_ahead import slip_ahead

Numbers = NDArray[Any]  # float32 or float64
Output = Literal["path", "end", "costs"]
OUTPUTS: tuple[Output, ...] = ("path", "end", "costs")
DEVICES = ("cpu", "cuda")


@dataclass(frozen=True, eq=False)
class Rollouts:
    """What N rollouts of K periods gave, rollouts side by side; None where it was not asked for."""

    path: Numbers | None = None  # [3, K, N] x, y [m], yaw [rad, not wrapped] at the end of each period
    end: Numbers | None = None  # [3, N] the same at the end of the last period
    costs: Numbers | None = None  # [3, N] sum, highest and lowest value of the map at the periods' ends
    covariance: Numbers | None = None  # [6, K, N] xx, xy, yy, xt, yt, tt of x, y, yaw

    def __repr__(self) -> str:
        parts = {f.name: getattr(self, f.name) for f in fields(self)}
        shown = (f"{name} {list(part.shape)}" for name, part in parts.items() if part is not None)
        return f"<Rollouts: {', '.join(shown)}>"


def command_buffer(rollouts: int, periods: int, dtype: DTypeLike = np.float32, *, axes: int = 2) -> Numbers:
    """Return zero commands [N, K, axes] that lie in memory as the kernels read them fastest.

    Any array of commands is taken; in one from here, those of one period lie side by side.
    """
    return np.zeros((axes, periods, rollouts), dtype=dtype).transpose(2, 1, 0)


def rollout(  # noqa: PLR0913  (all but the first three have defaults)
    model: Model,
    commands: ArrayLike,
    dt: float,
    *,
    start: Start | None = None,
    outputs: Collection[str] = ("path",),
    costmap: Costmap | None = None,
    covariance: bool = False,
    threads: int = 1,
    dtype: DTypeLike | None = None,
    out: Rollouts | None = None,
    level: str | None = None,
    device: str = "cpu",
) -> Rollouts:
    """Roll out `commands` through `model`: limits, actuator model, slip of any basis, exact steps.

    Args:
        model: a learned model. Commands are of the kind that it was learned from (`model.of_input`), as speed
            and yaw rate;
            those of a car with a steering angle are v and v tan(angle) / wheelbase, whose lags act on
            speed and steering. Those of a
            model of throttle and steering are these, in [-1, 1], as the past of the start is.
        commands: [N, K, 2] speed [m/s] and yaw rate [rad/s], each held for `dt`, from when the
            robot is at the start by the clock of the inputs; see `command_buffer`. Of a
            robot that drives sideways [N, K, 3]: v, vy, omega, as `models.axes.axes_of` says.
        dt: time that a command is held [s].
        start: where the rollouts start; by default at rest in the origin.
        outputs: of "path", "end" and "costs".
        costmap: what "costs" are sampled from.
        covariance: also the covariance of every pose from parameters and slip noise, grown as held-out
            predictions needed. It costs as much as ten to twenty rollouts of its type;
            derivatives are exact where the path has them. At a speed of zero they are the mean of both
            directions'.
        threads: the results are the same bytes for any number.
        dtype: float32 or float64; by default that of the commands.
        out: results of an earlier call of the same shape and dtype, whose arrays are filled again.
        level: instruction level of the processor, one of `_core.instruction_levels()` ("portable", "avx2",
            "avx512"); by default the best that it has.
        device: "cpu", or "cuda" for a GPU in a build with CUDA (docs/use-it-in-your-planner.md). Commands and
            results are copied; threads and level do not matter to it; a covariance is the processor's.

    Raises:
        ModelError: the model does not remember a surface ahead.
        SettingsError: the batch is empty, a command is not finite, something does not fit the rest, or
            there is no such device; it says why.
    """
    check_arguments(rollout, locals())
    model = model.body
    numbers = checked_commands(model, commands, dtype)
    check_threads(threads)
    warn_of_unseen_speeds(model, numbers, stacklevel=2)
    asked, at_start = numbers, Start() if start is None else start
    numbers, begin = behind_curves(model, asked, dt, at_start, threads)
    wanted = _wanted(outputs, costmap)
    rollouts, periods = numbers.shape[:2]
    buffers = {
        "path": _buffer("path", wanted, out, (3, periods, rollouts), numbers.dtype),
        "end": _buffer("end", wanted, out, (3, rollouts), numbers.dtype),
        "costs": _buffer("costs", wanted, out, (3, rollouts), numbers.dtype),
    }
    axes = drive_axes(model)
    starts = begin.in_core(rollouts, axes)
    gpu = gpu_of(device)
    slip = slip_ahead(begin.terrain_ahead, model)
    parameters, ahead = (model.mean, None) if slip is None else (slip.parameters(model), slip.in_core)
    try:
        model.refuse_heading("rollouts")
        program = _core.RolloutProgram(
            model.motion, parameters, dt, begin.ground, model.limits, ahead, axes.sideways
        )
        _core.rollout_batch(
            program,
            numbers,
            starts,
            buffers["path"],
            buffers["end"],
            None if costmap is None else costmap.in_core,
            buffers["costs"],
            threads,
            _core.instruction_levels()[-1] if level is None else level,
            gpu,
        )
        spread = None
        if covariance:

            def paths(twists: Numbers, begun: Start) -> Numbers:
                path = np.empty((3, periods, rollouts))
                begun_in_core, level = begun.in_core(rollouts, axes), _core.instruction_levels()[-1]
                _core.rollout_batch(
                    program, twists, begun_in_core, path, None, None, None, threads, level, None
                )
                return np.asarray(path)

            of_curves = curve_covariance(model, asked, dt, at_start, paths)
            spread = _covariance(model, numbers, dt, begin, threads, of_curves)
    except (ValueError, TypeError, RuntimeError) as problem:
        raise SettingsError(str(problem)) from problem
    return Rollouts(covariance=spread, **buffers)


def checked_commands(model: Model, commands: ArrayLike, dtype: DTypeLike | None) -> Numbers:
    """Return commands [N, K, axes] in float32 or float64, without a copy where they are.

    Raises:
        SettingsError: they are no such array, or the type is another one.
    """
    try:
        given = np.asarray(commands)
        kind = np.dtype((np.float32 if given.dtype == np.float32 else np.float64) if dtype is None else dtype)
        numbers = given.astype(kind, copy=False)
    except (TypeError, ValueError) as problem:
        raise SettingsError("the commands are no array of numbers", advice="give [N, K, axes]") from problem
    if kind not in (np.float32, np.float64):
        raise SettingsError(f"rollouts do not compute in {kind}", advice="use float32 or float64")
    axes = axes_of(model)
    if numbers.ndim != 3 or numbers.size == 0:
        raise SettingsError(
            f"the commands have shape {numbers.shape}",
            advice=f"give [N, K, {len(axes)}] with at least one rollout and period",
        )
    axes.check("the commands are rows", numbers.shape[2])
    return numbers


def check_threads(threads: int) -> None:
    """Refuse a number of threads that is none.

    Raises:
        SettingsError: it is less than 1.
    """
    if threads < 1:
        raise SettingsError(f"{threads} threads cannot work", advice="use threads=1 or more")


def uncertain(model: Model, dt: float, start: Start, horizon: float) -> _core.UncertainModel:
    """Return the model with its learned uncertainty, grown for `horizon` [s], for the core."""
    model = model.body
    model.refuse_heading("rollouts")
    slip = slip_ahead(start.terrain_ahead, model)
    scale = np.array(model.content.noise.variance_scale) if slip is None else slip.variance_scale
    parameters, covariance = model.mean, model.covariance
    if slip is not None:
        parameters, covariance = slip.parameters(model), slip.covariance(model)
    inflation = student_at(model, horizon).inflation
    spread = (covariance, model.noise, scale, inflation, model.disturbance, model.prior_std)
    ahead = None if slip is None else slip.in_core
    sideways = drive_axes(model).sideways
    setting = (dt, start.ground, model.limits, ahead, sideways)
    return _core.UncertainModel(model.motion, parameters, *spread, *setting)


def _covariance(  # noqa: PLR0913  (of one rollout)
    model: Model,
    commands: Numbers,
    dt: float,
    start: Start,
    threads: int,
    of_curves: NDArray[np.float64] | None,
) -> Numbers:
    rollouts, periods = commands.shape[:2]
    result: Numbers = np.empty((6, periods, rollouts), commands.dtype)
    unit = uncertain(model, dt, start, dt)
    starts = start.in_core(rollouts, drive_axes(model))
    inflation, _ = students_at(model, dt * np.arange(1, periods + 1))
    _core.rollout_covariance(unit, commands, starts, result, (inflation / inflation[0]).tolist(), threads)
    if of_curves is not None:
        result += of_curves
    return result


def _wanted(outputs: Collection[str], costmap: Costmap | None) -> frozenset[str]:
    wanted = frozenset((outputs,) if isinstance(outputs, str) else outputs)
    if unknown := sorted(wanted - set(OUTPUTS)):
        raise SettingsError(f"unknown output {unknown[0]!r}", advice=f"known are {', '.join(OUTPUTS)}")
    if ("costs" in wanted) != (costmap is not None):
        raise SettingsError("costs need a costmap, and a costmap gives costs", advice="give both or neither")
    return wanted


def _buffer(
    name: Output, wanted: frozenset[str], out: Rollouts | None, shape: tuple[int, ...], dtype: np.dtype[Any]
) -> Numbers | None:
    if name not in wanted:
        return None
    given: Numbers | None = None if out is None else getattr(out, name)
    if given is None:
        return np.empty(shape, dtype)
    if (
        given.shape != shape
        or given.dtype != dtype
        or not given.flags.c_contiguous
        or not given.flags.writeable
    ):
        raise SettingsError(
            f"the array for {name} has shape {given.shape} and type {given.dtype}",
            advice=f"give one of shape {shape} and type {dtype}, in one piece",
        )
    return given


def gpu_of(device: str) -> _core.Gpu | None:
    """Return the GPU that `device` names, None for the processor.

    Raises:
        SettingsError: there is no such device, or rollouts cannot run there; it says why.
    """
    if device not in DEVICES:
        raise SettingsError(f"unknown device {device!r}", advice=f"known are {', '.join(DEVICES)}")
    return None if device == "cpu" else _open_gpu()


@functools.cache
def _open_gpu() -> _core.Gpu:
    if reason := _core.why_no_gpu():
        raise SettingsError("no GPU", where="device 'cuda'", advice=reason)
    return _core.Gpu()
