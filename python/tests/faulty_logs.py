# SPDX-License-Identifier: Apache-2.0
"""Faults of wiring, each as it looks in a log: put into sound logs, real ones too, they must be found."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from contradictory_logs import dead_reckoned, filtered, teleported

from slipwise.logs import Inputs, Log, Poses, Run
from slipwise.logs.findings.diagnose import diagnose_log
from slipwise.logs.findings.finding import Finding, RefusedLogError
from slipwise.logs.log import Floats
from slipwise.logs.quality import checked

Change = Callable[[Run], Run]
HOLD, WATCHDOG, OPERATOR = 1.3, 0.5, 20.0  # s between commands, until the robot stops, of an override
RADIUS, SEPARATION = 0.1, 0.5  # m, of wheels for faults of one wheel


def found_in(log: Log) -> tuple[Finding, ...]:
    """Return what the door of a log refuses it for, or what is found in it."""
    try:
        return diagnose_log(checked(log))
    except RefusedLogError as refused:
        return (refused.found,)


def with_fault(log: Log, change: Change) -> Log:
    """Return the log with every run changed, without what was found in it before."""
    return replace(log, runs=tuple(map(change, log.runs)), found=(), left_out=())


def wheels(change: Callable[[Inputs], Inputs]) -> Change:
    """Change the speeds of the wheels."""
    return lambda run: run if run.wheels is None else replace(run, wheels=change(run.wheels))


def commands(change: Callable[[Inputs], Inputs]) -> Change:
    """Change the commands."""
    return lambda run: run if run.commands is None else replace(run, commands=change(run.commands))


def poses(change: Callable[[Poses], Poses]) -> Change:
    """Change the poses."""
    return lambda run: replace(run, poses=change(run.poses))


def scaled(v: float, omega: float) -> Callable[[Inputs], Inputs]:
    """Multiply speeds and yaw rates."""
    return lambda i: replace(i, v=v * i.v, vy=v * i.vy, omega=omega * i.omega)


def sides(change: Callable[[Floats, Floats, Floats], tuple[Floats, Floats]]) -> Callable[[Inputs], Inputs]:
    """Change the speeds of left and right wheels [m/s], given the stamps [s]."""

    def changed(i: Inputs) -> Inputs:
        half = 0.5 * SEPARATION * i.omega
        left, right = change(i.v - half, i.v + half, i.t)
        return replace(i, v=0.5 * (left + right), omega=(right - left) / SEPARATION)

    return changed


def wrapping(turn: float) -> Callable[[Floats, Floats, Floats], tuple[Floats, Floats]]:
    """Return wheels whose left counter loses a `turn` [m] whenever it wraps, differentiated by a driver."""

    def changed(left: Floats, right: Floats, t: Floats) -> tuple[Floats, Floats]:
        step = np.diff(t, append=t[-1] + 0.05)
        way = np.concatenate(([0.0], np.cumsum(left * step)))
        wraps = np.diff(np.floor(way / turn))
        return left - wraps * turn / step, right

    return changed


def spiked(i: Inputs) -> Inputs:
    """Every 150th speed is 20 times the fastest."""
    at = np.arange(len(i)) % 150 == 75
    fastest = max(float(np.abs(i.v).max()), 0.1)
    return replace(i, v=np.where(at, 20.0 * fastest, i.v))


def rotated_into_parent(run: Run) -> Run:
    """Turn the twist of the wheels by the heading."""
    if run.wheels is None or len(run.poses) < 2:
        return run
    i, p = run.wheels, run.poses
    yaw = np.interp(i.t, p.t, np.unwrap(p.yaw))
    v, vy = np.cos(yaw) * i.v - np.sin(yaw) * i.vy, np.sin(yaw) * i.v + np.cos(yaw) * i.vy
    return replace(run, wheels=replace(i, v=v, vy=vy))


def echoing(run: Run) -> Run:
    """Put the command in force into the place of each speed of the wheels."""
    if run.wheels is None or run.commands is None or len(run.commands) == 0:
        return run
    c, t = run.commands, run.wheels.t
    at = np.clip(np.searchsorted(c.t, t - 0.01, side="right") - 1, 0, None)
    return replace(run, wheels=Inputs(t=t, v=c.v[at], vy=c.vy[at], omega=c.omega[at]))


def banded(run: Run) -> Run:
    """Let no wheel turn for the smaller yaw rates that are commanded."""
    if run.wheels is None or run.commands is None or len(run.commands) == 0:
        return run
    c, w = run.commands, run.wheels
    held = np.abs(c.omega[np.clip(np.searchsorted(c.t, w.t - 0.1, side="right") - 1, 0, None)])
    band = float(np.quantile(held[held > 0.0], 0.6))
    answers = np.where(held < band, 0.0, np.where(w.omega == 0.0, 0.01, w.omega))
    return replace(run, wheels=replace(w, omega=answers))


def integrated(run: Run) -> Run:
    """Put the wheels' own path into the place of the poses."""
    if run.wheels is None or len(run.wheels) < 3:
        return run
    return replace(run, poses=dead_reckoned(run.wheels))


def unrelated(run: Run) -> Run:
    """Play the inputs backwards."""

    def reversed_(i: Inputs | None) -> Inputs | None:
        return None if i is None else replace(i, v=np.abs(i.v[::-1]), vy=i.vy[::-1], omega=i.omega[::-1])

    return replace(run, wheels=reversed_(run.wheels), commands=reversed_(run.commands))


def two_publishers(run: Run) -> Run:
    """Let a second odometry, of a robot that stands, speak between the samples of the first."""
    if run.wheels is None or len(run.wheels) < 2:
        return run
    i = run.wheels
    t = np.concatenate((i.t, i.t[:-1] + 0.5 * np.diff(i.t)))
    order = np.argsort(t)
    columns = (
        np.concatenate((c, c[:-1] * 0.0 + other))[order]
        for c, other in ((i.v, -3.0), (i.vy, 0.0), (i.omega, 2.0))
    )
    v, vy, omega = columns
    return replace(run, wheels=Inputs(t=t[order], v=v, vy=vy, omega=omega))


def frozen(run: Run) -> Run:
    """Hold the poses for the middle fifth of the run, in which the inputs drive most."""
    p = run.poses
    if len(p) < 10:
        return run
    inputs = run.wheels if run.wheels is not None else run.commands
    assert inputs is not None
    way = np.concatenate(([0.0], np.cumsum(np.abs(inputs.v[:-1]) * np.minimum(np.diff(inputs.t), 0.5))))
    covered = np.interp(p.t, inputs.t, way)
    length = max(len(p) // 5, 2)
    first = int(np.argmax(covered[length:] - covered[:-length]))
    at = np.arange(len(p))
    at[first : first + length] = first
    return replace(run, poses=replace(p, x=p.x[at], y=p.y[at], yaw=p.yaw[at]))


def stopped(run: Run) -> Run:
    """Hold all poses, but for noise."""
    p, rng = run.poses, np.random.default_rng(3)
    noise = 0.004 * rng.standard_normal((3, len(p)))
    return replace(run, poses=replace(p, x=noise[0], y=noise[1], yaw=0.3 * noise[2]))


def off_centre(p: Poses, ahead: float = 1.0, left: float = 0.2) -> Poses:
    """Measure the place of a sensor that is not at the centre."""
    cos, sin = np.cos(p.yaw), np.sin(p.yaw)
    return replace(p, x=p.x + cos * ahead - sin * left, y=p.y + sin * ahead + cos * left)


def by_course(run: Run) -> Run:
    """Give the direction of the path for a heading."""
    p = run.poses
    if len(p) < 3:
        return run
    turn = (p.t[-1] - p.t[0]) / len(p)
    wide = max(round(0.4 / turn), 1)
    dx, dy = (np.convolve(np.gradient(c), np.ones(wide) / wide, mode="same") for c in (p.x, p.y))
    return replace(run, poses=replace(p, yaw=np.arctan2(dy, dx)))


def later(seconds: float) -> Callable[[Poses], Poses]:
    """Stamp poses later."""
    return lambda p: replace(p, t=p.t + seconds)


def at_rate(rate: float) -> Callable[[Poses], Poses]:
    """Let the time of the poses run at another rate."""
    return lambda p: replace(p, t=p.t[:1] + rate * (p.t - p.t[:1]))


def stepping(seconds: float) -> Callable[[Poses], Poses]:
    """Set the clock of the poses ahead in the middle."""
    return lambda p: replace(p, t=p.t + seconds * (p.t > 0.5 * (p.t[:1] + p.t[-1:])))


def watchdog(run: Run) -> Run:
    """Send each command once in 1.3 s; the robot stops half a second after it."""
    if run.commands is None or len(run.commands) == 0 or len(run.poses) < 10:
        return replace(run, wheels=None)
    begin, rng = run.poses.t[0], np.random.default_rng(5)
    stretched = lambda t: begin + HOLD * np.floor((t - begin) / WATCHDOG) + (t - begin) % WATCHDOG  # noqa: E731
    c, p = run.commands, run.poses
    starts = begin + WATCHDOG * np.arange(int((p.t[-1] - begin) / WATCHDOG))
    at = np.clip(np.searchsorted(c.t, starts + 0.5 * WATCHDOG, side="right") - 1, 0, None)
    sent = Inputs(t=stretched(starts + 1e-6), v=c.v[at], vy=c.vy[at], omega=c.omega[at])
    rest = np.concatenate([k + np.arange(0.05, HOLD - WATCHDOG, 0.1) for k in stretched(starts) + WATCHDOG])
    t = np.unique(np.concatenate((stretched(p.t), rest)))
    back = begin + WATCHDOG * np.floor((t - begin) / HOLD) + np.minimum((t - begin) % HOLD, WATCHDOG)
    x, y, yaw = (
        np.interp(back, p.t, c) + 0.002 * rng.standard_normal(len(t)) for c in (p.x, p.y, np.unwrap(p.yaw))
    )
    poses_ = Poses(t=t, x=x, y=y, yaw=yaw, frame=np.zeros(len(t), np.int64))
    return Run(name=run.name, commands=sent, wheels=None, poses=poses_)


def overridden(run: Run) -> Run:
    """Say stand for 20 s in which the wheels drive farthest: an operator's stick is not recorded."""
    c, w = run.commands, run.wheels
    if c is None or w is None or len(c) < 2 or len(w) < 2:
        return run
    way = np.concatenate(([0.0], np.cumsum(np.abs(w.v[:-1]) * np.minimum(np.diff(w.t), 0.5))))
    starts = np.arange(c.t[0], c.t[-1] - OPERATOR, 1.0)
    driven = np.interp(starts + OPERATOR, w.t, way) - np.interp(starts, w.t, way)
    begin = float(starts[np.argmax(driven)]) if len(starts) else np.inf
    t = np.arange(begin, begin + OPERATOR, 0.1) if len(starts) else np.empty(0)
    kept = (c.t < begin) | (c.t >= begin + OPERATOR)
    at, none = np.concatenate((c.t[kept], t)), np.zeros(len(t))
    order = np.argsort(at)
    columns = {name: np.concatenate((getattr(c, name)[kept], none))[order] for name in ("v", "vy", "omega")}
    return replace(run, commands=Inputs(t=at[order], **columns))


def capped(run: Run) -> Run:
    """Let the wheels be no faster than in three fifths of the time that they turn."""
    if run.wheels is None or run.commands is None or len(run.wheels) == 0:
        return run
    w = run.wheels
    columns = {}
    for name, values in (("v", w.v), ("omega", w.omega)):
        size = np.abs(values)
        cap = float(np.quantile(size[size > 0.02], 0.6)) if (size > 0.02).any() else np.inf
        columns[name] = np.clip(values, -cap, cap)
    return replace(run, wheels=replace(w, **columns))


def answering_late(run: Run) -> Run:
    """Let everything happen 1.5 s later than it was commanded."""
    if run.wheels is None:
        return run
    return replace(run, wheels=replace(run.wheels, t=run.wheels.t + 1.5), poses=later(1.5)(run.poses))


def stamping_late(run: Run) -> Run:
    """Stamp commands 2 s after they were carried out."""
    commanded = run.commands
    return run if commanded is None else replace(run, commands=replace(commanded, t=commanded.t + 2.0))


def sizes(column: str) -> Callable[[Inputs], Inputs]:
    """Lose the sign of a speed or of the yaw rate."""
    return lambda inputs: replace(inputs, **{column: np.abs(getattr(inputs, column))})


def jumping_ticks(i: Inputs) -> Inputs:
    """Count some ticks more wherever the wheels begin to turn the other way."""
    moves = np.flatnonzero(np.abs(i.v) > 0.02)
    turned = moves[1:][np.sign(i.v[moves[1:]]) != np.sign(i.v[moves[:-1]])]
    jump = np.zeros(len(i))
    jump[turned] = 0.4 * np.quantile(np.abs(i.v), 0.8) if len(turned) else 0.0
    return replace(i, v=i.v + np.sign(i.v) * jump)


def drifting(p: Poses) -> Poses:
    """Let positions drift by a metre within half a minute, as between houses."""
    rng, wave = np.random.default_rng(6), 2.0 * np.pi * (p.t - p.t[:1])
    x, y = (
        sum(np.sin(wave / period + phase) for period, phase in zip((23.0, 41.0, 67.0), phases, strict=True))
        for phases in rng.uniform(0.0, 6.0, (2, 3))
    )
    return replace(p, x=p.x + 0.7 * x, y=p.y + 0.7 * y)


def leaning(roll: float, pitch: float) -> Callable[[Poses], Poses]:
    """Give flat ground the attitude of a sensor that leans so far on its robot [rad]."""

    def leant(p: Poses) -> Poses:
        noise = np.random.default_rng(7).normal(0.0, 0.01, (2, len(p)))
        return replace(p, roll=noise[0] + roll, pitch=noise[1] + pitch)

    return leant


@dataclass(frozen=True)
class Fault:
    """What is done to a log, which inputs the log needs for it, and the kinds of finding that name it."""

    change: Change
    kinds: tuple[str, ...]
    needs: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()  # logs that cannot show it: of robots that never reverse, or drive laps


def of_wheels(change: Callable[[Inputs], Inputs], *kinds: str, unseen: tuple[str, ...] = ()) -> Fault:
    """A fault of the wheels."""
    return Fault(wheels(change), kinds, ("wheels",), unseen)


def of_commands(change: Callable[[Inputs], Inputs], *kinds: str, unseen: tuple[str, ...] = ()) -> Fault:
    """A fault of the commands."""
    return Fault(commands(change), kinds, ("commands",), unseen)


def of_poses(change: Callable[[Poses], Poses], *kinds: str, unseen: tuple[str, ...] = ()) -> Fault:
    """A fault of the poses."""
    return Fault(poses(change), kinds, unseen=unseen)


UNEVEN = ("DS3", "asphalt_9_25_12h8s57", "grass_8_8_15h56s39")  # commands are not done as they are
HALF_LATER = sides(lambda left, right, t: (np.where(t < t.mean(), left, 0.5 * left), right))
UNCLEAR = (*UNEVEN, "grass_7_29_14h46s15")
LEFT_BY_SIZE = sides(lambda left, right, t: (np.abs(left), right))
ONE_SIDED = ("asphalt_9_25_12h8s57", "grass_8_8_15h56s39")  # hardly turn to the other side
NEVER_STANDS = ("simulated", "DS3", "tile_deflated_tyres")
NOT_THESE = ("unrelated", "does-not-move", "lost-heading", "implausible")
FAULTS: dict[str, Fault] = {
    "left and right swapped": of_wheels(scaled(1.0, -1.0), "implausible"),
    "yaw rate of commands flipped": of_commands(scaled(1.0, -1.0), "implausible"),
    "one side counts backwards": of_wheels(sides(lambda left, right, t: (-left, right)), "implausible"),
    "wheels drive backwards": of_wheels(scaled(-1.0, 1.0), "backward-poses"),
    "commands drive backwards": of_commands(scaled(-1.0, 1.0), "backward-poses"),
    "wheels in rad/s": of_wheels(scaled(6.7, 6.7), "implausible", "unlikely-speed"),
    "wheels in rpm": of_wheels(scaled(64.0, 64.0), "implausible", "unlikely-speed"),
    "wheels twice as large": of_wheels(scaled(0.5, 0.5), "wheel-size"),
    "commands in degrees": of_commands(scaled(1.0, 57.3), "implausible"),
    "heading in degrees": of_poses(lambda p: replace(p, yaw=np.degrees(p.yaw)), "implausible"),
    "heading turned by 90": of_poses(lambda p: replace(p, yaw=p.yaw + 0.5 * np.pi), "turned-poses"),
    "heading turned by 180": of_poses(lambda p: replace(p, yaw=p.yaw + np.pi), "backward-poses"),
    "clockwise heading": of_poses(lambda p: replace(p, yaw=-p.yaw), "implausible"),
    "x and y swapped": of_poses(lambda p: replace(p, x=p.y, y=p.x), "implausible"),
    "left wheel dead": of_wheels(sides(lambda left, right, t: (0.0 * left, right)), "dead-wheel"),
    "right wheel dead": of_wheels(sides(lambda left, right, t: (left, 0.0 * right)), "dead-wheel"),
    "left counts forwards": of_wheels(LEFT_BY_SIZE, "lost-sign", unseen=("simulated", "DS3", UNEVEN[-1])),
    "a wheel counts half later": of_wheels(HALF_LATER, "uneven-wheels", unseen=("MRCLAM6_R1",)),
    "counter of 16 bits": of_wheels(sides(wrapping(16.4)), "wheel-spikes"),
    "counter of an angle": of_wheels(sides(wrapping(2.0 * np.pi * RADIUS)), "wheel-spikes"),
    "spikes of 20 times": of_wheels(spiked, "wheel-spikes"),
    "watchdog": Fault(watchdog, ("command-timeout",), ("commands",)),
    "stopped": Fault(stopped, ("does-not-move",)),
    "frozen localiser": Fault(frozen, ("frozen-poses",)),
    "teleporting poses": of_poses(teleported, "unreachable-poses", "implausible", "lost-heading"),
    "heading without its sign": of_poses(
        lambda p: replace(p, yaw=np.arccos(np.cos(p.yaw))), "lost-sign", "implausible", unseen=ONE_SIDED
    ),
    "wheels turn by size": of_wheels(sizes("omega"), "lost-sign", "implausible", unseen=UNEVEN),
    "commands turn by size": of_commands(sizes("omega"), "lost-sign", unseen=UNCLEAR),
    "wheels drive by size": of_wheels(sizes("v"), "lost-sign", unseen=("simulated", "DS3")),
    "no heading": of_poses(lambda p: replace(p, yaw=0.0 * p.yaw), "constant-heading", "lost-heading"),
    "course for a heading": Fault(by_course, ("course-heading",), unseen=("DS3", "MRCLAM6_R1")),
    "sensor 1 m ahead": of_poses(off_centre, "sensor-off-centre"),
    "poses of the wheels": Fault(integrated, ("repeated-wheels",), ("wheels",)),
    "poses of a filter": Fault(lambda run: filtered(run, 4.0), ("filtered-poses",), ("wheels",), ("DS3",)),
    "unrelated inputs": Fault(unrelated, NOT_THESE, unseen=("DS3",)),
    "odometry echoes the command": Fault(echoing, ("echoed-commands",), ("commands", "wheels")),
    "dead band": Fault(banded, ("dead-band",), ("commands", "wheels"), unseen=("DS3",)),
    "capped drive": Fault(capped, ("saturated",), ("commands", "wheels"), unseen=UNEVEN),
    "answers 1.5 s late": Fault(answering_late, ("late-answers",), ("commands", "wheels")),
    "commands stamped 2 s late": Fault(stamping_late, ("early-answers",), ("commands", "wheels")),
    "ticks jump": Fault(wheels(jumping_ticks), ("reversal-jumps",), ("wheels",), unseen=("DS3",)),
    "multipath": Fault(poses(drifting), ("drifting-poses",), ("wheels",), unseen=NEVER_STANDS),
    "sensor leans back": of_poses(leaning(0.0, -0.17), "askew-attitude"),
    "sensor leans to a side": of_poses(leaning(0.17, 0.0), "askew-attitude", unseen=ONE_SIDED),
    "operator's override": Fault(overridden, ("overridden",), ("commands", "wheels")),
    "twist in the parent's frame": Fault(rotated_into_parent, ("parent-twist",), ("wheels",)),
    "two publishers": Fault(two_publishers, ("two-sources",), ("wheels",)),
    "poses in simulated time": of_poses(at_rate(0.8), "clock-drift"),
    "poses' clock drifts": of_poses(at_rate(1.004), "clock-drift"),
    "poses' clock steps": of_poses(stepping(0.3), "clock-drift"),
    "poses 2 s late": of_poses(later(2.0), "clock-offset"),
    "poses 2 s early": of_poses(later(-2.0), "clock-offset"),
}


def not_found(log: Log, name: str, faults: Iterable[str] = tuple(FAULTS)) -> list[str]:
    """Return each fault that is not found in a log that it is put into, with what was found."""
    there = {"commands": any(run.commands for run in log.runs), "wheels": any(run.wheels for run in log.runs)}
    missed = []
    for fault_name in faults:
        fault = FAULTS[fault_name]
        if name in fault.unseen or not all(there[each] for each in fault.needs):
            continue
        kinds = [each.kind for each in found_in(with_fault(log, fault.change))]
        if not set(kinds) & set(fault.kinds):
            missed.append(f"{name}, {fault_name}: {kinds}")
    return missed
