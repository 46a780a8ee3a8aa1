# SPDX-License-Identifier: Apache-2.0
"""Wheels of a described vehicle that contradict each other, and what explains it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise.calibration.calibrate import calibrate
from slipwise.live.lines import LineReader
from slipwise.logs import LogOptions, open_log
from slipwise.logs.findings.finding import Finding, RefusedLogError
from slipwise.logs.findings.wheel_layout import LayoutWatch, layout_findings
from slipwise.logs.log import Floats
from slipwise.logs.vehicle_description import VehicleDescription
from slipwise.logs.wheel_readings import wheel_names

PLACES = {"fl": (0.4, 0.3), "fr": (0.4, -0.3), "rl": (-0.4, 0.3), "rr": (-0.4, -0.3)}
SWERVE = VehicleDescription.model_validate(
    {"wheels": [{"name": n, "x": x, "y": y, "radius": 0.1, "steer": n} for n, (x, y) in PLACES.items()]}
)
AXLE = [{"name": n, "x": 0.0, "y": y, "radius": 0.15} for n, y in (("l", 0.25), ("r", -0.25))]
TOWED = [
    {"name": n, "x": -1.4, "y": y, "radius": 0.15, "behind_hinge": True, "driven": False}
    for n, y in (("tl", 0.25), ("tr", -0.25))
]
TOWING = VehicleDescription.model_validate({"wheels": AXLE + TOWED, "hinge": {"name": "hitch", "x": -0.5}})
QUARTER = np.pi / 4.0
MECANUM = VehicleDescription.model_validate(
    {
        "wheels": [
            {"name": n, "x": x, "y": y, "radius": 0.1, "roller": -QUARTER if n in ("fl", "rr") else QUARTER}
            for n, (x, y) in PLACES.items()
        ]
    }
)
KIWI = VehicleDescription.model_validate(
    {
        "wheels": [
            {
                "name": n,
                "x": 0.2 * np.cos(a),
                "y": 0.2 * np.sin(a),
                "radius": 0.05,
                "angle": a + 1.571,
                "roller": 0.0,
            }
            for n, a in (("left", np.pi / 3.0), ("rear", np.pi), ("right", -np.pi / 3.0))
        ]
    }
)
T = 0.05 * np.arange(2400)


def twists(sideways: float = 0.8) -> Floats:
    """Changing every two seconds."""
    random = np.random.default_rng(1)
    low, high = (0.2, -sideways, -0.6), (0.9, sideways, 0.6)
    return np.repeat(random.uniform(low, high, (len(T) // 40, 3)), 40, axis=0)


def swerve_readings() -> dict[str, Floats]:
    layout = SWERVE.layout
    assert layout is not None
    speed, steering = layout.wheels_for(twists())
    random = np.random.default_rng(2)
    readings = {f"wheel_{name}": speed[:, k] for k, name in enumerate(PLACES)}
    readings |= {f"steer_{name}": steering[:, k] for k, name in enumerate(PLACES)}
    return {name: values + 0.005 * random.normal(size=len(T)) for name, values in readings.items()}


def rolling_readings(vehicle: VehicleDescription) -> dict[str, Floats]:
    layout = vehicle.layout
    assert layout is not None
    speed, _ = layout.wheels_for(twists())
    random = np.random.default_rng(2)
    return {
        f"wheel_{wheel.name}": speed[:, k] + 0.005 * random.normal(size=len(T))
        for k, wheel in enumerate(vehicle.wheels)
    }


def towing_readings() -> dict[str, Floats]:
    """Of a trailer that follows its hitch."""
    motion, angle = twists(0.0), np.zeros(len(T))
    for i in range(1, len(T)):
        v, _, omega = motion[i - 1]
        sideways = -0.5 * omega  # m/s, of the hitch
        turn = (v * np.sin(-angle[i - 1]) + sideways * np.cos(angle[i - 1])) / 0.9  # of the trailer
        angle[i] = angle[i - 1] + 0.05 * (turn - omega)
    sides = {"wheel_l": motion[:, 0] - 0.25 * motion[:, 2], "wheel_r": motion[:, 0] + 0.25 * motion[:, 2]}
    return {name: speeds / 0.15 for name, speeds in sides.items()} | {"steer_hitch": angle}


def found_in(vehicle: VehicleDescription, readings: dict[str, Floats]) -> tuple[Finding, ...]:
    return layout_findings(vehicle, wheel_names(vehicle, readings), readings, T)


def exchanged(readings: dict[str, Floats], *pairs: tuple[str, str]) -> dict[str, Floats]:
    other = dict(pairs) | {b: a for a, b in pairs}
    return {
        f"{of}_{other.get(name, name)}": readings[f"{of}_{name}"]
        for of in ("wheel", "steer")
        for name in PLACES
    }


def test_wheels_of_one_body_agree() -> None:
    assert found_in(SWERVE, swerve_readings()) == ()
    assert found_in(TOWING, towing_readings()) == ()


def test_few_readings_and_a_standing_robot_say_nothing() -> None:
    readings = {name: values[:50] for name, values in swerve_readings().items()}
    readings["wheel_fl"] = 0.0 * readings["wheel_fl"]
    names = wheel_names(SWERVE, readings)
    assert layout_findings(SWERVE, names, readings, T[:50]) == ()
    still = {name: np.zeros(len(T)) for name in readings}
    assert layout_findings(SWERVE, names, still, T) == ()


@pytest.mark.parametrize(
    ("changed", "cause"),
    [
        (lambda r: exchanged(r, ("fl", "fr"), ("rl", "rr")), "left and right are exchanged"),
        (lambda r: exchanged(r, ("fl", "rl"), ("fr", "rr")), "front and rear are exchanged"),
        (lambda r: exchanged(r, ("fl", "fr")), "fl and fr are exchanged"),
        (lambda r: r | {"wheel_fl": -r["wheel_fl"]}, "fl turns backwards"),
        (lambda r: r | {"wheel_fl": 0.0 * T}, "the speed of fl is wrong or missing"),
        (lambda r: r | {"wheel_fl": np.where(T < 60.0, r["wheel_fl"], 0.0)}, "the speed of fl is wrong"),
        (lambda r: r | {"steer_fl": -r["steer_fl"]}, "the steering of fl counts to the right"),
        (lambda r: r | {"steer_fl": np.degrees(r["steer_fl"])}, "the steering of fl is in degrees"),
        (lambda r: r | {"steer_fl": 0.0 * T}, "nothing that fl says is read"),
        (
            lambda r: r | {name: np.degrees(r[name]) for name in r if name.startswith("steer")},
            "angles of steering are degrees",
        ),
    ],
)
def test_what_explains_wheels_that_contradict_each_other_is_named(changed, cause: str) -> None:  # type: ignore[no-untyped-def]
    (found,) = found_in(SWERVE, changed(swerve_readings()))
    assert (found.kind, found.spoils) == ("wheel-layout", True)
    assert cause in found.advice[0]


def test_a_module_that_is_askew_is_a_reservation() -> None:
    readings = swerve_readings()
    (found,) = found_in(SWERVE, readings | {"steer_fl": readings["steer_fl"] + 0.3})
    assert (found.spoils, found.reserves) == (False, True)


def test_wheels_that_slide_across_are_no_fault_but_are_to_be_said() -> None:
    rigid = VehicleDescription.model_validate(
        {"wheels": [{"name": n, "x": x, "y": y, "radius": 0.1} for n, (x, y) in PLACES.items()]}
    )
    motion = twists(0.0)
    sides = {n: (motion[:, 0] - 0.45 * np.sign(y) * motion[:, 2]) / 0.1 for n, (_, y) in PLACES.items()}
    (found,) = found_in(rigid, {f"wheel_{name}": speeds for name, speeds in sides.items()})
    assert (found.spoils, found.reserves) == (False, True)
    assert "slides" in found.advice[0]


def test_a_wheel_that_never_turns_is_found_where_the_others_do_not_need_it() -> None:
    readings = rolling_readings(KIWI)
    assert found_in(KIWI, readings) == ()
    for begins in (0.0, 60.0):
        (still,) = found_in(
            KIWI, readings | {"wheel_rear": np.where(begins > T, readings["wheel_rear"], 0.0)}
        )
        assert (still.kind, still.spoils) == ("still-wheel", True)
        assert f"wheel_rear stays at 0 rad/s for {120.0 - begins:.0f} s" in still.sentence
    ahead = {"wheel_left": -readings["wheel_right"], "wheel_rear": 0.0 * T}  # along one line it need not turn
    assert found_in(KIWI, readings | ahead) == ()


def test_a_wheel_of_another_size_and_a_side_that_turns_backwards_are_named() -> None:
    readings = rolling_readings(MECANUM)
    assert found_in(MECANUM, readings) == ()
    (larger,) = found_in(MECANUM, readings | {"wheel_fr": 1.3 * readings["wheel_fr"]})
    assert (larger.spoils, larger.reserves) == (False, True)
    assert "where fr turns 0.77 times as far as it counts" in larger.advice[0]
    right = {name: -readings[name] for name in ("wheel_fr", "wheel_rr")}
    (backwards,) = found_in(MECANUM, readings | right)
    assert backwards.spoils
    assert "fr and rr turn backwards (reversed)" in backwards.advice[0]


def test_a_hinge_that_never_moves_is_found_and_one_that_counts_to_the_right() -> None:
    readings = towing_readings()
    (still,) = found_in(TOWING, readings | {"steer_hitch": 0.0 * T})
    assert (still.kind, still.spoils) == ("still-hinge", True)
    (turned,) = found_in(TOWING, readings | {"steer_hitch": -readings["steer_hitch"]})
    assert turned.spoils
    assert "steer_hitch counts to the right" in turned.advice[0]


def table(folder: Path, readings: dict[str, Floats]) -> tuple[Path, LogOptions]:
    vehicle, path = folder / "swerve.yaml", folder / "swerve.csv"
    wheels = "".join(
        f"    - {{name: {n}, x: {x}, y: {y}, radius: 0.1, steer: {n}}}\n" for n, (x, y) in PLACES.items()
    )
    vehicle.write_text(f"vehicle:\n  wheels:\n{wheels}")
    motion = twists()
    yaw = np.cumsum(0.05 * motion[:, 2])
    step = np.array([motion[:, 0] * np.cos(yaw) - motion[:, 1] * np.sin(yaw), motion[:, 0] * np.sin(yaw)])
    step[1] += motion[:, 1] * np.cos(yaw)
    x, y = np.cumsum(0.05 * step, axis=1)
    columns = {"t": T, "x": x, "y": y, "yaw": yaw, **readings}
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, fmt="%.6f", delimiter=",", header=",".join(columns), comments="")
    return path, LogOptions(vehicle=str(vehicle))


def test_a_table_its_lines_and_the_verdict_say_the_same(tmp_path: Path) -> None:
    readings = swerve_readings()
    path, options = table(tmp_path, readings | {"wheel_fl": 0.0 * T})
    log = open_log(path, options=options)
    (found,) = (each for each in log.found if each.kind == "wheel-layout")
    assert found.sentence in calibrate(log).verdict.sentence
    reader = LineReader(options)
    for line in path.read_text().splitlines():
        reader.read(line)
    (live,) = reader.found()
    assert live == found


def test_poses_that_turn_the_other_way_are_not_said_of_a_layout_that_explains_it(tmp_path: Path) -> None:
    readings = swerve_readings()
    path, options = table(tmp_path, exchanged(readings, ("fl", "rl"), ("fr", "rr")))
    with pytest.raises(RefusedLogError, match="wheels contradict each other"):
        open_log(path, options=options)


def test_a_live_robot_may_leave_readings_out_and_be_asked_at_once() -> None:
    watch = LayoutWatch(SWERVE)
    assert watch.found() == ()
    readings = swerve_readings() | {"wheel_fl": 0.0 * T}
    for k, t in enumerate(T):
        watch.take({name: values[k] for name, values in readings.items()}, t)
        watch.take({"wheel_fl": 1.0}, t)
    (found,) = watch.found()
    assert (found,) == found_in(SWERVE, readings)
