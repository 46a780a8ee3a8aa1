# SPDX-License-Identifier: Apache-2.0
"""AMCL's alpha1 to alpha5 from the learned noise (derivations/odometry.md)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumbers
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, stated, yaml_value
from slipwise.export.reference_drive import learned_variances, motion_covariance, reference_drive
from slipwise.models.model import Model

UPDATE_DISTANCE = 0.25  # m, update_min_d: AMCL draws its noise again after this distance
UPDATE_ANGLE = 0.2  # rad, update_min_a
_MEANING = (
    "rotation from rotation",
    "rotation from translation [rad^2/m^2]",
    "translation from translation",
    "translation from rotation [m^2/rad^2]",
    "sideways from translation",
)
_TWO_MODELS = """\
The omnidirectional sample model is for any robot here: it moves particles as the odometry says, and it alone
has sideways noise. It spreads them as the model does, on straight drives and on turns; where AMCL updates
more often than after the distance or the angle below, it draws less. These are for the differential model,
which spreads too little sideways and on arcs, and too much on turns on the spot:
robot_model_type: "nav2_amcl::DifferentialMotionModel"
"""


@dataclass(frozen=True)
class Alphas:
    """alpha1 to alpha5 for AMCL's two sample models."""

    differential: tuple[float, float, float, float, float]
    omni: tuple[float, float, float, float, float]


def alphas(model: Model, horizon: float) -> Alphas:
    """Return the alphas with which AMCL's particles spread as the model says, within `horizon` [s].

    AMCL draws noise again in each update, with a variance in proportion to the square of the update's motion.
    n updates of length d over the distance D = n d have the variance n alpha d^2 = alpha d D, so that
    alpha = S / (d D).

    Raises:
        ModelError: the robot never drove, or never turned.
    """
    drive = reference_drive(model)
    straight = motion_covariance(model, (drive.speed, 0.0), horizon)
    turn = motion_covariance(model, (0.0, drive.yaw_rate), horizon)
    per_distance = 1.0 / (UPDATE_DISTANCE * drive.speed * horizon)
    per_angle = 1.0 / (UPDATE_ANGLE * drive.yaw_rate * horizon)
    rotation, position = turn[2, 2] * per_angle, (turn[0, 0] + turn[1, 1]) * per_angle
    along, heading = straight[0, 0] * per_distance, straight[2, 2] * per_distance
    updates = drive.speed * horizon / UPDATE_DISTANCE
    from_heading = (
        heading * UPDATE_DISTANCE**4 * max(0.0, (updates - 1.0) * updates * (2.0 * updates - 1.0) / 6.0)
    )
    sideways = max(0.0, straight[1, 1] - from_heading) * per_distance
    # Of a turn on the spot the differential model sees one rotation, of an arc two halves: half the variance.
    # The factor sqrt(2) lies between.
    between = float(np.sqrt(2.0))
    return Alphas(
        differential=(between * rotation, heading / 2.0, along, between * position, sideways),
        omni=(rotation, heading, along, position / 2.0, sideways),
    )


def amcl(model: Model, options: ExportOptions) -> ParameterFile:
    """Return AMCL's noise parameters for its omnidirectional sample model; a comment has the differential's.

    Raises:
        ModelError: the model was learned from commands, or noise cannot be stated.
    """
    if model.content.input != "wheel":
        raise ModelError(
            "AMCL's alphas are the noise of wheel odometry, and this model is from commands",
            advice="calibrate with `--input wheel`",
        )
    drive = reference_drive(model)
    entries = _alphas(model, options.horizon, lambda found: found.omni)
    other = _alphas(model, options.horizon, lambda found: found.differential)
    unknown = [entry.why for entry in entries if isinstance(entry, Kept)]
    if len(unknown) == len(entries):
        raise ModelError(
            f"none of AMCL's alphas is known: {unknown[0]}", advice="calibrate with a longer log"
        )
    return ParameterFile(
        node="amcl",
        entries=[
            Entry(
                ("robot_model_type",),
                "nav2_amcl::OmniMotionModel",
                "the sample model that they are for",
            ),
            Entry(
                ("update_min_d",),
                UPDATE_DISTANCE,
                "[m] AMCL's default; the alphas hold for this distance only",
            ),
            Entry(
                ("update_min_a",), UPDATE_ANGLE, "[rad] AMCL's default; the alphas hold for this angle only"
            ),
            *entries,
        ],
        notes=[
            (
                "Names of Nav2's nav2_amcl, all versions. For odometry with the multipliers of\n"
                "diff_drive_controller.yaml; what these leave over is not in the noise.\n"
                f"Noise as the model predicts it {options.horizon:g} s ahead, at {drive.speed:.3g} m/s and"
                f" {drive.yaw_rate:.3g} rad/s."
            ),
            _TWO_MODELS + "\n".join(_in_comment(entry) for entry in other),
        ],
    )


def _alphas(
    model: Model, horizon: float, of_alphas: Callable[[Alphas], tuple[float, ...]]
) -> list[Entry | Kept]:
    numbers = LearnedNumbers(model)
    found = learned_variances(model, lambda each: np.array(of_alphas(alphas(each, horizon))))
    return [
        stated((f"alpha{i}",), number, meaning, numbers)
        for i, (number, meaning) in enumerate(zip(found, _MEANING, strict=True), start=1)
    ]


def _in_comment(entry: Entry | Kept) -> str:
    return f"{entry.name}: {yaml_value(entry.value) if isinstance(entry, Entry) else entry.why}"
