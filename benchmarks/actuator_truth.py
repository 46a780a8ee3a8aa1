# SPDX-License-Identifier: Apache-2.0
"""Are lag, delay, gain, clock offset, lever arm and slip found, and is the reported uncertainty of each true?

For each seed a robot's parameters are drawn from the prior and a drive is simulated, without the core's
actuator. Then it is learned: from commands alone, with the users' settings and once more with the true
shape of the noise, whose size is learned; and from commands and wheel speeds in cascade. Some drives are
simulated with rigid-body physics (MuJoCo), behind whose commands there is a known lag and delay; a heavy body
on tyres follows its wheels later still, by as much as its exact states show. A dull drive (constant speed,
straight on) must be said not to determine what it cannot show.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.learner import CASCADED, Posterior, posterior_of
from slipwise.logs import Inputs, Log, Poses
from slipwise.segments import recording_of
from slipwise_sim import LandTamer, Scenario, simulate
from slipwise_sim.known_robot import KnownRobot, Pair, known_run
from slipwise_sim.truth import Truth

Floats = NDArray[np.float64]
Slips = Callable[[Floats, Floats], Sequence[Floats]]  # what of v and omega a twist is a sum of

SECONDS, DULL_SECONDS = 240.0, 60.0
SETTLED = 20.0  # s of driving before a dull drive is recorded
BASIS = "edd-2"
SPEEDS, YAW_RATES = (-0.5, 1.5), (-0.8, 0.8)  # m/s, rad/s
HELD = (0.5, 4.0)  # s that a command lasts
COMMAND_PERIOD = 0.05  # s
LEARN = {"basis": BASIS, "sensor_extrinsics": {"learn": True}}
ROBOT = KnownRobot()
TRUE_NOISE = {
    "psd_time": list(ROBOT.slip_psd),
    "psd_motion": [0.0] * 3,
    "fraction": [0.0] * 3,
    "pose_std_xy": ROBOT.pose_std[0],
    "pose_std_yaw": ROBOT.pose_std[1],
}
PHYSICS_BASIS = "drive-5"  # real slip is not edd-2: sideways slip in curves would pass for a lever arm
PHYSICS_LATE = 0.05  # s that poses are stamped late
PHYSICS_SENSOR = (1.5, -0.3, 0.1)  # m, m, rad
FINE = 0.001  # s, steps of the exact answer to commands


@dataclass(frozen=True)
class Found:
    """One parameter of one run."""

    name: str
    true: float
    value: float
    std: float
    prior_std: float

    @property
    def sigmas(self) -> float:
        """How far off, in reported standard deviations."""
        return (self.value - self.true) / self.std


def drawn_robot(seed: int) -> KnownRobot:
    """Draw a robot from the prior; half of what commands alone would call delay is clock offset."""
    rng = np.random.default_rng([seed, 0])
    prior = _core.PriorSettings()

    def lognormal(median: float) -> tuple[float, float]:
        v, omega = median * np.exp(prior.log_std * rng.standard_normal(2))
        return float(v), float(omega)

    def normal(mean: float, std: float) -> tuple[float, float]:
        v, omega = mean + std * rng.standard_normal(2)
        return float(v), float(omega)

    sensor = rng.standard_normal(3) * (prior.extrinsics_std, prior.extrinsics_std, prior.sensor_yaw_std)
    return KnownRobot(
        lag=lognormal(prior.time_constant),
        delay=lognormal(prior.delay),
        basis=_core.named_basis(BASIS),
        slip=normal(0.0, 0.5 * prior.slip_fraction),
        sensor=(float(sensor[0]), float(sensor[1]), float(sensor[2])),
    )


def with_response(robot: KnownRobot, seed: int) -> KnownRobot:
    """The same robot with gains, a slow mode and late poses, which wheel speeds can show."""
    rng = np.random.default_rng([seed, 1])
    prior = _core.PriorSettings()
    gain = 1.0 + prior.gain_std * rng.standard_normal(2)
    fraction = prior.slow_fraction_std * rng.standard_normal(2)
    slow = np.maximum(
        prior.slow_time_constant * np.exp(prior.log_std * rng.standard_normal(2)), 2.0 * np.array(robot.lag)
    )
    return replace(
        robot,
        gain=(float(gain[0]), float(gain[1])),
        slow_fraction=(float(fraction[0]), float(fraction[1])),
        slow_time_constant=(float(slow[0]), float(slow[1])),
        poses_late=abs(float(prior.clock_offset_std * rng.standard_normal())),
    )


def commands(seed: int, seconds: float) -> Inputs:
    """Return random speeds and yaw rates, held for a while each."""
    rng = np.random.default_rng([seed, 2])
    t = np.round(np.arange(0.0, seconds, COMMAND_PERIOD), 6)
    count = int(seconds / HELD[0]) + 1
    at = np.searchsorted(np.cumsum(rng.uniform(*HELD, count)), t, side="right")
    v, omega = rng.uniform(*SPEEDS, count)[at], rng.uniform(*YAW_RATES, count)[at]
    return Inputs(t=t, v=v, vy=np.zeros(len(t)), omega=omega)


def truth_of(robot: KnownRobot, *, wheels: bool) -> dict[str, float]:
    """Return every parameter's true value; without wheel speeds, delays contain all clock offsets."""
    late = robot.wheels_late if wheels else robot.wheels_late + robot.poses_late
    names = [info.name for info in _core.MotionModel(robot.basis, False, False).parameters]
    true = dict(zip(names, robot.slip, strict=True))
    for k, channel in enumerate(("v", "omega")):
        true |= {
            f"log_time_constant_{channel}": float(np.log(robot.lag[k])),
            f"log_delay_{channel}": float(np.log(robot.delay[k] + late)),
            f"gain_{channel}": robot.gain[k],
            f"slow_fraction_{channel}": robot.slow_fraction[k],
            f"log_slow_time_constant_{channel}": float(np.log(robot.slow_time_constant[k])),
        }
    sensor = dict(zip(("sensor_x", "sensor_y", "sensor_yaw"), robot.sensor, strict=True))
    return true | {"clock_offset": robot.poses_late} | sensor


def judged(motion: _core.MotionModel, posterior: Posterior, true: dict[str, float]) -> list[Found]:
    """Hold a posterior against the truth."""
    std = np.sqrt(np.diag(posterior.covariance))
    return [
        Found(
            info.name, true[info.name], float(posterior.mean[i]), float(std[i]), float(posterior.prior_std[i])
        )
        for i, info in enumerate(motion.parameters)
    ]


def from_commands_told_noise(seed: int) -> list[Found]:
    """Learn from commands alone, with the true shape of the noise."""
    return from_commands(seed, given=LEARN | {"noise": TRUE_NOISE})


def from_commands(
    seed: int, seconds: float = SECONDS, *, given: Mapping[str, object] = MappingProxyType(LEARN)
) -> list[Found]:
    """Learn from commands alone, by the settings `given`."""
    robot = drawn_robot(seed)
    run = known_run(robot, commands(seed, seconds), (0.0, seconds), random=np.random.default_rng([seed, 3]))
    log = Log(runs=(replace(run, wheels=None),))
    model = calibrate(log, input="command", settings=make_settings(dict(given))).model
    true = truth_of(robot, wheels=False)
    return [Found(p.name, true[p.name], p.value, p.std, p.prior_std) for p in model.content.parameters]


def from_wheels_too(seed: int, seconds: float = SECONDS, rate: float = ROBOT.rate) -> list[Found]:
    """Learn the actuator from commands and wheel speeds at `rate` [Hz], the rest from these and poses."""
    robot = replace(with_response(drawn_robot(seed), seed), rate=rate)
    run = known_run(robot, commands(seed, seconds), (0.0, seconds), random=np.random.default_rng([seed, 3]))
    assert run.wheels is not None
    amid = replace(run.wheels, t=run.wheels.t + 0.5 / robot.rate)  # of what each wheel speed is the mean of
    run = replace(run, wheels=amid)
    alone = {"bases": [LEARN["basis"]], "structures": ["joint", "cascaded"]}
    settings = make_settings({**LEARN, "basis": "auto", "auto": alone})
    learner = _core.MotionLearner(core_settings(settings, "command", ()))
    learner.start_run()
    learner.push(recording_of(run))
    learner.end_run()
    learned = [event for event in learner.events() if event.kind == _core.EventKind.SegmentLearned]
    cascaded = learned[-1].posterior(CASCADED)
    assert cascaded is not None
    return judged(cascaded.model, posterior_of(cascaded), truth_of(robot, wheels=True))


def in_physics(seed: int) -> list[Found]:
    """Learn the actuator and the sensor of a simulated Land Tamer from its commands."""
    vehicle = LandTamer()
    simulation = simulate(Scenario(duration=SECONDS, vehicle=vehicle, pose_delay=PHYSICS_LATE), seed=seed)
    (run,) = simulation.log.runs
    assert run.commands is not None
    log = Log(runs=(replace(run, wheels=None, poses=_seen(run.poses, PHYSICS_SENSOR)),))
    settings = make_settings(LEARN | {"basis": PHYSICS_BASIS})
    model = calibrate(log, input="command", settings=settings).model
    true = dict(zip(("sensor_x", "sensor_y", "sensor_yaw"), PHYSICS_SENSOR, strict=True))
    for channel, (lag, delay) in shown_responses(simulation.truth, run.commands, vehicle).items():
        true[f"log_time_constant_{channel}"] = float(np.log(lag))
        true[f"log_delay_{channel}"] = float(np.log(delay + PHYSICS_LATE))
    known = [p for p in model.content.parameters if p.name in true]
    return [Found(p.name, true[p.name], p.value, p.std, p.prior_std) for p in known]


def shown_responses(truth: Truth, commanded: Inputs, vehicle: LandTamer) -> dict[str, Pair]:
    """Lag and delay [s] of speed and yaw rate by which a body's exact twist follows its commands best.

    The wheels have the vehicle's lag and delay. The body has some 25 ms more: its mass on soft tyres.
    """
    from scipy.optimize import least_squares
    from scipy.signal import lfilter

    t = np.arange(0.0, truth.t[-1] + FINE / 2, FINE)
    held = np.searchsorted(commanded.t, t, side="right") - 1

    def answer(wish: Floats, lag: float, delay: float) -> Floats:
        keep = np.exp(-FINE / lag)
        follows = lfilter([1.0 - keep], [1.0, -keep], wish[held])
        return np.asarray(np.interp(truth.t - delay, t + FINE, follows))

    def misfit(lag_delay: Floats, slips: Slips, twist: Floats) -> Floats:
        v, omega = answer(commanded.v, *lag_delay), answer(commanded.omega, *lag_delay)
        terms = np.stack(slips(v, omega), axis=1)
        return np.asarray(terms @ np.linalg.lstsq(terms, twist, rcond=None)[0] - twist)

    start = (vehicle.command_lag, vehicle.command_delay)
    of_v = least_squares(misfit, start, args=(lambda v, _: (v,), truth.vx)).x.tolist()
    of_omega = least_squares(misfit, start, args=(lambda v, w: (w, v, v * w), truth.omega)).x.tolist()
    return {"v": tuple(of_v), "omega": tuple(of_omega)}


def _seen(poses: Poses, sensor: tuple[float, float, float]) -> Poses:
    """The poses of a sensor that the robot carries."""
    x, y, yaw = sensor
    c, s = np.cos(poses.yaw), np.sin(poses.yaw)
    turned = poses.yaw + yaw
    return replace(
        poses,
        x=poses.x + c * x - s * y,
        y=poses.y + s * x + c * y,
        yaw=np.arctan2(np.sin(turned), np.cos(turned)),
    )


def dull(seed: int) -> tuple[str, ...]:
    """Return what a straight drive at constant speed is said not to determine."""
    rng = np.random.default_rng([seed, 4])
    robot = drawn_robot(seed)
    t = np.round(np.arange(0.0, SETTLED + DULL_SECONDS, COMMAND_PERIOD), 6)
    commanded = Inputs(
        t=t, v=np.full(len(t), rng.uniform(0.3, 1.5)), vy=np.zeros(len(t)), omega=np.zeros(len(t))
    )
    run = known_run(robot, commanded, (SETTLED, SETTLED + DULL_SECONDS), random=rng)
    log = Log(runs=(replace(run, wheels=None),))
    return calibrate(log, input="command", settings=make_settings(LEARN)).verdict.not_identifiable


NOT_SHOWN = (
    "log_time_constant_v",
    "log_time_constant_omega",
    "log_delay_v",
    "log_delay_omega",
    "sensor_x",
    "sensor_y",
)


LEARNERS = {
    "commands alone": from_commands,
    "commands alone, shape of the noise commanded": from_commands_told_noise,
    "commands and wheels": from_wheels_too,
}


def table(runs: Sequence[list[Found]]) -> None:
    """Print how often each parameter lies within its reported standard deviations."""
    print(f"{'parameter':20s}  within 3   68 %    95 %    mean z   rms z   rms error   std / prior")
    every = []
    for rows in zip(*runs, strict=True):
        z = np.array([row.sigmas for row in rows])
        every.append(z)
        error = np.sqrt(np.mean([(row.value - row.true) ** 2 for row in rows]))
        learned = np.median([row.std / row.prior_std for row in rows])
        _row(rows[0].name, z, f"{error:9.4f}   {learned:9.3f}")
    _row("all", np.concatenate(every), "")


def _row(name: str, z: Floats, rest: str) -> None:
    within = [100.0 * np.mean(np.abs(z) < limit) for limit in (3.0, 1.0, 1.959964)]
    print(
        f"{name:20s} {within[0]:8.1f} {within[1]:8.1f} {within[2]:7.1f} {z.mean():8.2f} "
        f"{np.sqrt(np.mean(z**2)):8.2f}  {rest}"
    )


def main() -> None:
    """Run all seeds and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--physics", type=int, default=40, help="drives simulated with rigid-body physics")
    parser.add_argument("--json", type=Path, help="write every run's result here")
    options = parser.parse_args()
    seeds = range(options.runs)
    report: dict[str, object] = {}
    with ProcessPoolExecutor() as pool:
        for label, learn in LEARNERS.items():
            runs = list(pool.map(learn, seeds, chunksize=2))
            print(f"\n== {label}, {len(runs)} runs of {SECONDS:g} s ==\n")
            table(runs)
            report[label] = [[asdict(found) for found in run] for run in runs]
        if options.physics:
            runs = list(pool.map(in_physics, range(options.physics)))
            print(f"\n== rigid-body physics, commands alone, {len(runs)} runs of {SECONDS:g} s ==\n")
            table(runs)
            report["physics"] = [[asdict(found) for found in run] for run in runs]
        said = list(pool.map(dull, seeds, chunksize=2))
    print(f"\n== straight on at constant speed, {len(said)} runs of {DULL_SECONDS:g} s ==\n")
    for name in NOT_SHOWN:
        print(f"{name:20s} said to be not_identifiable in {sum(name in names for names in said)}")
    report["dull"] = [list(names) for names in said]
    if options.json:
        options.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
