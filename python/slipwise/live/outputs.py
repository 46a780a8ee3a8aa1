# SPDX-License-Identifier: Apache-2.0
"""What the node gives to planners, odometry, people and files."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.learned_sequence import SurfaceSummary
from slipwise.models import Model

Floats = NDArray[np.float64]
Validity = Literal["unestimated", "estimated", "invalid"]


@dataclass(frozen=True, eq=False)
class Odometry:
    """The fused pose and the twist with learned slip, `~/odometry` and `~/twist`."""

    t: float  # s
    frame: str  # of the pose: that of the pose sensor
    child_frame: str  # base_link
    pose: Floats  # [3] x, y [m], yaw [rad]
    pose_covariance: Floats  # [3, 3]
    twist: Floats  # [3] v, vy [m/s], omega [rad/s] in the child frame
    twist_covariance: Floats  # [3, 3]
    since_pose: float  # s, for which no pose came: dead reckoning


@dataclass(frozen=True, eq=False)
class Path:
    """Where the present command leads, `~/predicted_path`, or the answer to a request."""

    t: Floats  # [N] s
    frame: str
    poses: Floats  # [N, 3] x, y [m], yaw [rad] in that frame
    covariance: Floats  # [N, 3, 3]
    asked: bool = False  # on request


@dataclass(frozen=True)
class NoPrediction:
    """The answer to a request that came by lines, of a path that cannot be predicted."""

    why: str


@dataclass(frozen=True)
class ParameterNow:
    """A parameter of the model as it is now, in physical units."""

    name: str
    unit: str
    value: float
    std: float
    prior_std: float
    validity: Validity
    start: float  # its value when the node started
    applied: float | None = None  # what others were given; None: nothing
    target_std: float = math.nan  # at which it is identified

    @property
    def known(self) -> float | None:
        """How far its standard deviation came from the prior's to the target: 0 to 1; None: no target."""
        return filled(self.prior_std, self.std, self.target_std)


def filled(prior: float, now: float, target: float) -> float | None:
    """Return how much of a bar is full, 0 to 1, by the logarithm of a standard deviation.

    None where a number is not finite or makes no sense.
    """
    if not (math.isfinite(prior + now + target) and prior > 0.0 and now >= 0.0 and target >= 0.0):
        return None
    if now <= target:
        return 1.0
    if target <= 0.0:
        return 0.0
    whole = math.log(prior / target)
    return 0.0 if whole <= 0.0 else min(max(math.log(prior / now) / whole, 0.0), 1.0)


@dataclass(frozen=True)
class MoveNow:
    """A command worth holding, from standing, and the knowledge after it and those before it."""

    v: float  # m/s
    omega: float  # rad/s
    seconds: float  # held
    yaw_std: float  # rad, of the worst prediction over 2 s
    position_std: float  # m, likewise
    teaches: str  # the parameter of which most is learned


@dataclass(frozen=True)
class SureNow:
    """How sure the worst prediction over 2 s is."""

    name: str  # "yaw" or "position"
    unit: str
    prior_std: float  # before anything was learned
    std: float
    target_std: float  # as sure as one measured move

    @property
    def known(self) -> float | None:
        """How far the standard deviation came from the prior's to the target: 0 to 1."""
        return filled(self.prior_std, self.std, self.target_std)


@dataclass(frozen=True)
class NextMovesNow:
    """The moves worth driving next, `~/next_moves` (latched)."""

    t: float  # s
    moves: tuple[MoveNow, ...]
    predictions: tuple[SureNow, ...]
    parameters: tuple[ParameterNow, ...]
    why: str = ""  # there are no moves


@dataclass(frozen=True)
class SurfaceNow:
    """The surface that is driven on, `~/surface`, and what is remembered, `~/surface_json` (both latched)."""

    t: float  # s
    name: str  # the likeliest; empty: one that has no name yet
    probability: float  # of it
    probabilities: tuple[tuple[str, float], ...]  # of all that it may be, the likeliest first
    remembered: tuple[SurfaceSummary, ...]
    labels: tuple[float, float]  # that were judged by what was driven, and that were right


@dataclass(frozen=True, eq=False)
class Status:
    """The state of the node, `~/diagnostics` and `~/slip_state`: a new one several times a second."""

    t: float  # s, stamp of the newest measurement
    vehicle: str
    input: str  # "command" or "wheel"
    state: str  # "waiting", "learning", "not learning", "stuck"
    why: str  # of the state, in words: "no pose yet", "an operator drives", ...
    validity: Validity  # of the model as a whole
    validity_why: str
    parameters: tuple[ParameterNow, ...]
    driven: Floats  # [N, 3] the last measured poses, oldest first
    odometry: Odometry | None
    predicted: Path | None
    slip: Floats | None  # [3] slip now: forward, sideways [m/s], yaw rate [rad/s]; the model minus the input
    nis: float | None  # normalised innovation squared of the newest segment, expected 3
    held_out: tuple[float, float, float, float] | None  # position [m], heading [rad], the baseline's
    segments: int  # learned so far
    counts: dict[str, int]  # what was rejected, by reason
    log: tuple[tuple[float, str], ...]  # the last things said: stamp [s], text
    apply: str  # "off", "manual" or "auto"
    given: str = ""  # which model others have, such as "valid" or "the start model; ..."
    surface: SurfaceNow | None = None  # where surfaces are remembered


@dataclass(frozen=True)
class ModelText:
    """The model file as text, `~/model`, and its numbers, `~/motion_model` (both latched)."""

    t: float  # s
    before: str  # the model's own text; all there is where there is no model
    model: Model | None = None  # whose numbers are given too
    vehicle: str = ""
    given: str = ""  # which model it is, in words
    validity: Validity = "unestimated"

    @cached_property
    def text(self) -> str:
        """All of it, made when somebody asks for it first."""
        return self.before + ("" if self.model is None else self.model.to_yaml())


@dataclass(frozen=True)
class Note:
    """Something said once."""

    t: float  # s
    text: str
    error: bool = False  # shown whoever asked for quiet


@dataclass(frozen=True)
class AppliedParameters:
    """Parameters that a running node is to be given."""

    t: float  # s
    target: str  # such as "mppi"
    node: str  # such as "/controller_server"
    values: dict[str, Any]  # by the parameter's full name
    file: str = ""  # which holds the same, for a restart of the node


Output = (
    Odometry | Path | NoPrediction | Status | SurfaceNow | NextMovesNow | ModelText | Note | AppliedParameters
)


def next_moves_content(now: NextMovesNow) -> dict[str, Any]:
    """Return the moves and how far each bar is full as JSON has it; null stands for what is not finite."""
    return {
        "moves": [{key: _short(value) for key, value in asdict(move).items()} for move in now.moves],
        "predictions": {each.name: _bar(each, each.unit) for each in now.predictions},
        "parameters": {each.name: _bar(each, each.unit) for each in now.parameters},
        "why": now.why,
    }


def _bar(each: ParameterNow | SureNow, unit: str) -> dict[str, Any]:
    stds = {"prior_std": each.prior_std, "std": each.std, "target_std": each.target_std}
    known = {"known": None if each.known is None else round(each.known, 3)}
    return known | {key: _short(value) for key, value in stds.items()} | {"unit": unit}


def _short(value: Any) -> Any:
    """Return a number with four significant digits, None where it is not finite; all else as it is."""
    if not isinstance(value, float):
        return value
    return float(f"{value:.4g}") if math.isfinite(value) else None


def surface_content(now: SurfaceNow) -> dict[str, Any]:
    """Return the surface and what is remembered as JSON has it; the name "" is of one that has none yet."""
    judged, right = now.labels
    return {
        "surface": now.name,
        "probability": round(now.probability, 4),
        "probabilities": {name: round(value, 4) for name, value in now.probabilities},
        "remembered": [asdict(each) for each in now.remembered],
        "labels": {"all": judged, "right": right},
    }
