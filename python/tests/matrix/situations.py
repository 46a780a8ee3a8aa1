# SPDX-License-Identifier: Apache-2.0
"""The situations that every use is tried in. To add one is to add an entry to `SITUATIONS`."""

from __future__ import annotations

import math
from dataclasses import replace

from matrix import logs
from matrix.logs import PoseSensor, Sensor
from matrix.simulator import Axis, Robot
from matrix.situation import SECONDS, Situation

DRIVE = (Axis(delay=0.15, lag=0.3), Axis(delay=0.1, lag=0.2))
HELD = 0.025  # s, half the period of the wheel speeds: held until the next, they are so late
LAGS = {"delay_v": 0.15, "time_constant_v": 0.3, "delay_omega": 0.1, "time_constant_omega": 0.2}
SLIP = {"lon.V": -0.06, "ang.w": -0.25}
PLAIN = Robot(axes=DRIVE, slip=SLIP)
TIGHTER = replace(PLAIN, slip={"lon.V": -0.06, "ang.w": -0.4})
TOLD, WHEELS, POSES = logs.commands("cmd_v", "cmd_omega"), logs.odometry(), PoseSensor()
OMNI = Robot(axes=(DRIVE[0], DRIVE[0], DRIVE[1]), slip={"lon.V": -0.05, "lat.Vy": -0.25, "ang.w": -0.1})
OMNI_RANGES = ((-0.5, 1.0), (-0.6, 0.6), (-0.8, 0.8))
OMNI_TRUTH = {"lon.V": -0.05, "lat.Vy": -0.25, "ang.w": -0.1}
MECANUM = """vehicle:
  wheels:
    - {name: fl, x: 0.2, y: 0.2, radius: 0.05, roller: -0.785398}
    - {name: fr, x: 0.2, y: -0.2, radius: 0.05, roller: 0.785398}
    - {name: rl, x: -0.2, y: 0.2, radius: 0.05, roller: 0.785398}
    - {name: rr, x: -0.2, y: -0.2, radius: 0.05, roller: -0.785398}
"""
CORNERS = {"fl": (0.4, 0.3), "fr": (0.4, -0.3), "rl": (-0.4, 0.3), "rr": (-0.4, -0.3)}
SWERVE = "vehicle:\n  wheels:\n" + "".join(
    f"    - {{name: {name}, x: {x}, y: {y}, radius: 0.1, steer: {name}}}\n"
    for name, (x, y) in CORNERS.items()
)
TRACKS = "vehicle:\n  tracks: {radius: 0.1, separation: 0.5}\n"
CAR = "vehicle:\n  wheelbase: 0.3\n  throttle_steering: {top_speed: 3.0, curvature: 1.2}\n"
THROTTLE = Robot(
    axes=(Axis(delay=0.1, lag=0.4), Axis(delay=0.1, lag=0.12)),
    kind="throttle",
    speeds=((-1.0, 0.0, 0.15, 0.6, 1.0), (-1.0, 0.0, 0.0, 1.6, 2.2)),
    curvatures=((-1.0, 0.0, 1.0), (-1.3, 0.05, 1.1)),
)
SLOWER = replace(THROTTLE, speeds=(THROTTLE.speeds[0], tuple(0.7 * v for v in THROTTLE.speeds[1])))
CAR_SENSORS = (logs.commands("throttle", "steering"),)
CAR_RANGES = ((0.1, 0.8), (-1.0, 1.0))
STEERED = Robot(axes=(DRIVE[0], Axis(delay=0.1, lag=0.15)), kind="steering", slip=SLIP)
SLOPING = Robot(axes=DRIVE, slip={**SLIP, "lat.abs(V)*gy": 0.05}, slope=math.radians(9.0))

SLIPPERY = replace(PLAIN, slip={"lon.V": -0.2, "ang.w": -0.5})
LIMITED = (replace(DRIVE[0], saturation=0.8, slew=0.8), replace(DRIVE[1], slew=1.5))
CREEP = {**SLIP, "lat.abs(V)*gy": 0.05}  # of a known force, which acts as gravity does
CREEPS = ("basis=custom", 'terms.lon=["V"]', 'terms.lat=["abs(V)*gy"]', 'terms.ang=["w"]')
HITCH = (0.3, 1.0)  # m: behind the robot, and its length
TURNS = {"ang.w": -0.25}
COLUMNS = ("lines", "parquet", "mcap")  # of its logs are those of another situation
UNCHANGED = ("inspect", "fleet", *COLUMNS)  # by what learning begins with
IEKF = ("basis=edd-2", "estimator=iekf")
BATCH = ("basis=edd-2", "estimator=batch")
SMOOTH = ("basis=edd-2", "smoothing.smooth=true")
CURVED = replace(
    THROTTLE, curvatures=(THROTTLE.curvatures[0], tuple(1.4 * c for c in THROTTLE.curvatures[1]))
)
UPHILL = replace(THROTTLE, slip={"lon.abs(V)*gx": 0.05, "lat.abs(V)*gy": 0.05}, slope=math.radians(9.0))
SHOVED = replace(THROTTLE, slip={"lat.abs(V)*gy": 0.05}, force=(1.5, 7.0))
SOURCES = (
    PoseSensor(source="lidar"),
    PoseSensor(source="gnss", std=(0.05, 0.0), yaw=False, late=0.2, since=0.03),
)


def of_car(name: str, *sensors: Sensor, robot: Robot = THROTTLE, **changes: object) -> Situation:
    """Return a situation of a car that is commanded by throttle and steering."""
    known: dict[str, object] = {
        "options": {"vehicle": "@car.yaml"},
        "settings": (),
        "files": {"car.yaml": CAR},
        "ranges": CAR_RANGES,
        "never": ("at once",),
        "bound": (0.15, 0.08),
        "seconds": 120.0,
        "changed": SLOWER,
    }
    return Situation(name, robot, (*CAR_SENSORS, *sensors), **{**known, **changes})  # type: ignore[arg-type]


def of_turns(name: str, driven: Sensor, learns: str = "command") -> Situation:
    """Return a situation in which a gyro alone measures."""
    sensors = (driven, logs.gyro())
    also = ("several-logs",)
    return Situation(name, PLAIN, sensors, learns, truth=TURNS, changed=TIGHTER, turns=True, also=also)


SITUATIONS: tuple[Situation, ...] = (
    Situation("wheels", PLAIN, (WHEELS, POSES), "wheel", truth=SLIP, changed=TIGHTER, also=("several-logs",)),
    Situation(
        "commands",
        PLAIN,
        (TOLD, POSES),
        truth=SLIP | LAGS,
        changed=TIGHTER,
        never=("at once",),
        also=("several-logs",),
    ),
    Situation(
        "limits",
        replace(PLAIN, axes=LIMITED),
        (TOLD, WHEELS, POSES),
        settings=(),
        changed=replace(TIGHTER, axes=LIMITED),
        never=("at once",),
        bound=(0.1, 0.06),
        without=COLUMNS,
    ),
    Situation("both", PLAIN, (TOLD, WHEELS, POSES), settings=(), changed=TIGHTER, never=("at once",)),
    Situation(
        "sideways",
        OMNI,
        (logs.commands("cmd_vx", "cmd_vy", "cmd_omega"), POSES),
        settings=(),
        ranges=OMNI_RANGES,
        changed=replace(OMNI, slip={**OMNI_TRUTH, "ang.w": -0.3}),
    ),
    Situation(
        "sideways-vehicle",
        OMNI,
        (logs.commands("cmd_vx", "cmd_vy", "cmd_omega"), POSES),
        options={"vehicle": "@mecanum.yaml"},
        settings=("basis=omni-8",),
        files={"mecanum.yaml": MECANUM},
        ranges=OMNI_RANGES,
        truth=OMNI_TRUTH,
        changed=replace(OMNI, slip={**OMNI_TRUTH, "lat.Vy": -0.4}),
    ),
    Situation(
        "swerve",
        replace(OMNI, axes=(Axis(lag=0.3), Axis(lag=0.3), Axis(lag=0.2))),
        (logs.steered(CORNERS, 0.1), POSES),
        "wheel",
        options={"vehicle": "@swerve.yaml"},
        settings=("basis=omni-8",),
        files={"swerve.yaml": SWERVE},
        ranges=OMNI_RANGES,
        truth=OMNI_TRUTH,
        changed=replace(OMNI, slip={**OMNI_TRUTH, "lat.Vy": -0.4}),
        bound=(0.04, 0.03),
    ),
    Situation(
        "steering",
        STEERED,
        (logs.commands("cmd_v", "cmd_steer"), POSES),
        options={"wheelbase": 0.5},
        ranges=((0.2, 1.2), (-0.4, 0.4)),
        changed=replace(STEERED, slip={"lon.V": -0.06, "ang.w": -0.4}),
        says=("steering commands",),
        never=("at once", "yaw[- ]rate"),
    ),
    of_car("throttle", POSES, also=("several-logs",), says=(r"after 0\.10",)),
    of_car("throttle-tighter", POSES, changed=CURVED, uses=("compare", "fleet")),
    of_car("throttle-odometry", logs.odometry("odo_v"), POSES, uses=("inspect", "calibrate")),
    of_car("throttle-positions", PoseSensor(yaw=False), uses=("calibrate", "replay")),
    of_car("throttle-gyro", logs.gyro(), uses=("calibrate",), turns=True),
    of_car(
        "throttle-slopes",
        PoseSensor(space=True),
        robot=UPHILL,
        uses=("inspect", "calibrate"),
        notes=("roll and pitch are not used",),
    ),
    of_car(
        "throttle-force",
        POSES,
        logs.known_force(),
        robot=SHOVED,
        uses=("inspect", "calibrate"),
        notes=("known forces are not used",),
    ),
    Situation(
        "tracks",
        PLAIN,
        (logs.sides(0.1, 0.5), POSES),
        "wheel",
        options={"vehicle": "@tracks.yaml"},
        files={"tracks.yaml": TRACKS},
        truth=SLIP,
        changed=TIGHTER,
    ),
    Situation(
        "trailer",
        PLAIN,
        (TOLD, WHEELS, POSES, logs.hitch(*HITCH)),
        truth=SLIP,
        changed=TIGHTER,
        also=("dynamics",),
    ),
    Situation(
        "positions",
        PLAIN,
        (WHEELS, PoseSensor(yaw=False)),
        "wheel",
        truth=SLIP,
        changed=TIGHTER,
    ),
    Situation(
        "positions-gyro",
        PLAIN,
        (WHEELS, PoseSensor(yaw=False, std=(0.03, 0.0)), logs.gyro()),
        "wheel",
        truth=SLIP,
        changed=TIGHTER,
    ),
    of_turns("gyro", WHEELS, learns="wheel"),
    of_turns("gyro-commands", TOLD),
    Situation(
        "sources",
        PLAIN,
        (WHEELS, *SOURCES),
        "wheel",
        truth=SLIP,
        changed=TIGHTER,
    ),
    Situation(
        "sources-iekf",
        PLAIN,
        (WHEELS, *SOURCES),
        "wheel",
        settings=IEKF,
        uses=("calibrate",),
        notes=("gnss are not used",),
    ),
    Situation(
        "sources-smooth",
        PLAIN,
        (WHEELS, *SOURCES),
        "wheel",
        settings=SMOOTH,
        uses=("calibrate",),
        notes=("gnss are not used",),
    ),
    Situation(
        "slopes",
        SLOPING,
        (TOLD, PoseSensor(space=True)),
        settings=(),
        seconds=1.5 * SECONDS,  # after 80 s the standard deviation of a prediction is that of the bound
        truth={"lat.abs(V)*gy": 0.05},
        changed=replace(SLOPING, slip={**SLIP, "ang.w": -0.4, "lat.abs(V)*gy": 0.05}),
    ),
    Situation(
        "force",
        replace(PLAIN, slip=CREEP, force=(1.5, 7.0)),
        (WHEELS, POSES, logs.known_force()),
        "wheel",
        settings=CREEPS,
        truth=CREEP,
        changed=replace(TIGHTER, force=(1.5, 7.0)),
    ),
    Situation(
        "force-late",
        replace(PLAIN, slip=CREEP, force=(1.5, 7.0)),
        (WHEELS, POSES, logs.known_force(10.0, 0.05)),
        "wheel",
        settings=CREEPS,
        truth=CREEP,
        uses=("inspect", "calibrate"),
    ),
    Situation(
        "force-body",
        replace(PLAIN, slip={**SLIP, "lat.abs(V)": 0.06}),
        (WHEELS, POSES),
        "wheel",
        settings=("basis=edd-2", "body_force.frame=body"),
        truth=SLIP,
        pushes=("lat.abs(V)",),
        changed=TIGHTER,
        without=COLUMNS,
    ),
    Situation(
        "force-world",
        replace(PLAIN, wind=(0.04, 0.05)),
        (WHEELS, POSES),
        "wheel",
        settings=("basis=edd-2", "body_force.frame=world"),
        truth=SLIP,
        bound=(0.04, 0.03),
        changed=TIGHTER,
        without=COLUMNS,
    ),
    Situation(
        "memory",
        PLAIN,
        (WHEELS, POSES),
        "wheel",
        before=(SLIPPERY, (WHEELS, POSES)),
        truth=SLIP,
        changed=TIGHTER,
        also=("several-logs",),
        without=UNCHANGED,
    ),
    Situation(
        "labels",
        PLAIN,
        (WHEELS, POSES, logs.label("sand")),
        "wheel",
        before=(SLIPPERY, (WHEELS, POSES, logs.label("ice"))),
        without=("fleet",),
        truth=SLIP,
        changed=TIGHTER,
    ),
    Situation(
        "extrinsics",
        PLAIN,
        (WHEELS, PoseSensor(place=(0.4, -0.15, 0.0))),
        "wheel",
        settings=("basis=edd-2", "sensor_extrinsics.x=0.2", "sensor_extrinsics.learn=true"),
        truth={**SLIP, "sensor_x": 0.4, "sensor_y": -0.15},
        changed=TIGHTER,
        without=COLUMNS,
    ),
    Situation(
        "clock",
        PLAIN,
        (WHEELS, PoseSensor(late=0.15)),
        "wheel",
        truth={**SLIP, "clock_offset": 0.15 - HELD},
        changed=TIGHTER,
        without=COLUMNS,
    ),
    Situation(
        "prior",
        PLAIN,
        (WHEELS, POSES),
        "wheel",
        truth=SLIP,
        fleet=True,
        without=(*UNCHANGED, "replay"),  # `live` begins with no fleet
        slow=True,
        changed=TIGHTER,
        seconds=40.0,
    ),
    Situation(
        "own-basis",
        replace(PLAIN, slip={"lon.V": -0.06, "ang.w": -0.2, "ang.w*abs(V)": -0.1}),
        (WHEELS, POSES),
        "wheel",
        settings=("basis=custom", 'terms.lon=["V"]', 'terms.ang=["w", "w*abs(V)"]'),
        truth={"lon.V": -0.06, "ang.w": -0.2, "ang.w*abs(V)": -0.1},
        changed=TIGHTER,
        without=COLUMNS,
    ),
    Situation("iekf", PLAIN, (WHEELS, POSES), "wheel", settings=IEKF, truth=SLIP, changed=TIGHTER),
    Situation("batch", PLAIN, (TOLD, POSES), settings=BATCH, truth=SLIP, changed=TIGHTER),
    Situation(
        "smoothing",
        PLAIN,
        (WHEELS, POSES),
        "wheel",
        settings=SMOOTH,
        truth=SLIP,
        changed=TIGHTER,
        without=COLUMNS,
    ),
)
