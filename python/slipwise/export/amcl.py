# SPDX-License-Identifier: Apache-2.0
"""AMCL's alpha1 to alpha5 from the learned noise (derivations/odometry.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumbers
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, for_release, stated
from slipwise.export.reference_drive import learned_variances, motion_covariance, reference_drive
from slipwise.export.ros_tables import AMCL
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
_OF_DIFFERENTIAL = 4  # alphas that the differential sample model reads
DEFAULT = 0.2  # of each alpha in Nav2
_DIFFERENTIAL, _OMNI = "nav2_amcl::DifferentialMotionModel", "nav2_amcl::OmniMotionModel"
_OMNI_NOTE = """\
The omnidirectional sample model moves particles as the odometry says, and has sideways noise. Where AMCL
updates more often than after the distance or the angle below, it draws less."""
_DIFFERENTIAL_NOTE = """\
The differential sample model spreads too little sideways and on arcs, and too much on turns on the spot:
these lie between. Where AMCL updates more often than after the distance or the angle below, it draws less."""
CAUTION = """\
CAUTION: alphas far below AMCL's default of 0.2 leave its particles no room for what is in no odometry model:
a wrong map, a kidnapped robot, a wheel that lifts. AMCL then loses the robot and does not find it again. What
was learned is how noisy this odometry is, not how much AMCL needs: an alpha below the default is written with
`--small-alphas` alone. Raise them again where the particles collapse while the scan does not fit the map."""


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
    """Return AMCL's noise parameters for the sample model of the robot's kind.

    Raises:
        ModelError: the model was learned from commands, or noise cannot be stated.
    """
    if model.content.input != "wheel":
        raise ModelError(
            "AMCL's alphas are the noise of wheel odometry, and this model is from commands",
            advice="calibrate with `--input wheel`",
        )
    drive = reference_drive(model)
    alphas_learned = _alphas(model, options)
    unknown = [entry.why for entry in alphas_learned if isinstance(entry, Kept)]
    if len(unknown) == len(alphas_learned):
        raise ModelError(
            f"no alpha of AMCL can be written: {unknown[0]}", advice="calibrate with a longer log"
        )
    entries = [
        Entry(
            ("robot_model_type",),
            _OMNI if options.omni else _DIFFERENTIAL,
            "the sample model that they are for",
            supposed=True,
        ),
        Entry(
            ("update_min_d",),
            UPDATE_DISTANCE,
            "[m] AMCL's default; the alphas hold for this distance only",
            supposed=True,
        ),
        Entry(
            ("update_min_a",),
            UPDATE_ANGLE,
            "[rad] AMCL's default; the alphas hold for this angle only",
            supposed=True,
        ),
        *(entry if options.small_alphas else _not_small(entry) for entry in alphas_learned),
    ]
    return ParameterFile(
        node="amcl",
        entries=for_release(entries, AMCL),
        notes=[
            (
                "Names of Nav2's nav2_amcl, all versions. For odometry with the multipliers of\n"
                "diff_drive_controller.yaml; what these leave over is not in the noise.\n"
                f"Noise as the model predicts it {options.horizon:g} s ahead, at {drive.speed:.3g} m/s and"
                f" {drive.yaw_rate:.3g} rad/s."
            ),
            _OMNI_NOTE if options.omni else _DIFFERENTIAL_NOTE,
            CAUTION,
        ],
    )


def _alphas(model: Model, options: ExportOptions) -> list[Entry | Kept]:
    numbers = LearnedNumbers(model)
    kind = "omni" if options.omni else "differential"
    found = learned_variances(model, lambda each: np.array(getattr(alphas(each, options.horizon), kind)))
    named = list(zip(found, _MEANING, strict=True))
    return [
        stated((f"alpha{i}",), number, meaning, numbers)
        for i, (number, meaning) in enumerate(named if options.omni else named[:_OF_DIFFERENTIAL], start=1)
    ]


def _not_small(entry: Entry | Kept) -> Entry | Kept:
    if isinstance(entry, Kept) or not isinstance(entry.value, float) or entry.value >= DEFAULT:
        return entry
    return Kept(
        entry.key,
        f"learned {entry.value:.3g} ({entry.meaning}), below AMCL's default of {DEFAULT:g}:"
        " --small-alphas writes it",
    )
