# SPDX-License-Identifier: Apache-2.0
"""Drives a slalom with one controller and models from several sources, to see which drives better."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from slipwise.calibration import Settings, calibrate, make_settings
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.live.samples import Sample
from slipwise.models import Model
from slipwise.planning import Motion, learned_motions, vendor_motion
from slipwise_sim import Scenario, simulate
from slipwise_sim.demo.motion_sources import FixedMotion, FloorMotions, LiveMotion, MotionSource
from slipwise_sim.demo.run_demo import VENDOR_WHEEL_SEPARATION_MULTIPLIER
from slipwise_sim.demo.slalom_course import FLOORS, Floor, SlalomCourse, slalom_course
from slipwise_sim.demo.slalom_drive import POSE_STD, SlalomDrive, Trace

INPUT = "command"  # what a controller sends
LOG_SECONDS = 240.0  # [s] of the drives that the models are learned from
LOG_SEED = 5  # of these drives
SHORT = 1.0  # [s] of the segments of the variant that reacts sooner; from commands they last 2.5 s by default
AFTER_RESTART = 10_000  # added to a drive's seed: the second drive has noise of its own

VENDOR, FIRST_FLOOR, LIVE = "vendor constants", "off-line model of the first floor", "live"
LIVE_SHORT, RESTARTED, EACH_FLOOR = "live, segments of 1 s", "live, restarted", "a model for each floor"
VARIANTS = (VENDOR, FIRST_FLOOR, LIVE, LIVE_SHORT, RESTARTED, EACH_FLOOR)


@dataclass(frozen=True, eq=False)
class Driven:
    """How a drive went."""

    trace: Trace
    arrived: bool


def vendor() -> list[Motion]:
    """Return what a vendor's constants say: a wheel separation multiplier, no lag and no delay."""
    return [vendor_motion(VENDOR_WHEEL_SEPARATION_MULTIPLIER)]


def floor_model(floor: Floor) -> Model:
    """Return the model that `calibrate` learns from a simulated drive on one floor.

    Raises:
        SlipwiseError: MuJoCo is not installed.
    """
    scenario = Scenario(duration=LOG_SECONDS, tyre=floor.law, std_xy=POSE_STD[0], std_yaw=POSE_STD[1])
    return calibrate(simulate(scenario, seed=LOG_SEED).log, input=INPUT).model


def drive_course(course: SlalomCourse, source: MotionSource, *, seed: int) -> Driven:
    """Drive once; the source receives each measurement and returns a model, every control period.

    Args:
        course: where to drive.
        source: of the controller's model.
        seed: of noise and of the controller's samples.

    Raises:
        SlipwiseError: MuJoCo is not installed.
    """
    drive = SlalomDrive(course, vendor(), seed=seed)
    samples: list[Sample] = []
    while not drive.finished:
        motions = source.motions(drive.floor, samples)
        if motions is not None:
            drive.adopt(motions)
        samples = drive.advance()
    return Driven(drive.trace, drive.arrived)


def drive_all(seed: int, models: Sequence[Model]) -> dict[str, Driven]:
    """Drive the course of a seed once with every variant, by name.

    The restarted learner drives the course a second time, from the state that the live one saved at its end:
    it comes from the last floor, and begins on the first.

    Args:
        seed: of the course, and of what is random on it.
        models: one learned model for each of `FLOORS`.

    Raises:
        SlipwiseError: MuJoCo is not installed.
    """
    course = slalom_course(seed, floors=FLOORS)
    live = LiveMotion(MotionLearner(INPUT), vendor())
    short: Settings = make_settings({"segment": {"length": SHORT}})
    driven = {
        VENDOR: drive_course(course, FixedMotion(vendor()), seed=seed),
        FIRST_FLOOR: drive_course(course, FixedMotion(learned_motions(models[0])), seed=seed),
        LIVE: drive_course(course, live, seed=seed),
        LIVE_SHORT: drive_course(course, LiveMotion(MotionLearner(INPUT, short), vendor()), seed=seed),
        EACH_FLOOR: drive_course(course, FloorMotions(models), seed=seed),
    }
    saved = MotionLearner.load(live.learner.save())
    driven[RESTARTED] = drive_course(course, LiveMotion(saved, vendor()), seed=seed + AFTER_RESTART)
    return {name: driven[name] for name in VARIANTS}
