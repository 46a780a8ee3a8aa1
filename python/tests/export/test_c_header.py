# SPDX-License-Identifier: Apache-2.0
"""The C header compiles without a warning as C99 and C++, and predicts what slipwise predicts."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_models import LIMITS, Made, make_model, named

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.export import export_model
from slipwise.export.c_header import c_header
from slipwise.models import Model
from slipwise.prediction import predict

pytestmark = pytest.mark.slow

Floats = NDArray[np.float64]

STRICT = ("-Wall", "-Wextra", "-Werror", "-pedantic", "-fno-math-errno")
TOLERANCE = {"float": 1e-4, "double": 1e-9}
DRIVER = r"""
#include <stdio.h>
#include "model.h"

/* Reads capacity and commands, then windows: start end gx gy known v omega. Prints status and pose. */
int main(void) {
  slipwise_command slots[512];
  slipwise_commands commands;
  double t, v, omega, end, gx, gy;
  int capacity, count, known, refused = 0;
  if (scanf("%d %d", &capacity, &count) != 2) {
    return 1;
  }
  slipwise_commands_init(&commands, slots, capacity);
  for (; count > 0 && scanf("%lf %lf %lf", &t, &v, &omega) == 3; --count) {
    refused += 0 != slipwise_command_push(&commands, (slipwise_real)t, (slipwise_real)v,
                                          (slipwise_real)omega);
  }
  printf("%d %d\n", refused, commands.count);
  while (scanf("%lf %lf %lf %lf %d %lf %lf", &t, &end, &gx, &gy, &known, &v, &omega) == 7) {
    slipwise_window window;
    slipwise_drive drive, after = {0, 0};
    slipwise_pose pose = {0, 0, 0};
    int status;
    drive.v = (slipwise_real)v;
    drive.omega = (slipwise_real)omega;
    window.start = (slipwise_real)t;
    window.end = (slipwise_real)end;
    window.drive = known ? &drive : 0;
    window.gx = (slipwise_real)gx;
    window.gy = (slipwise_real)gy;
    status = slipwise_predict(&commands, &window, &pose, &after);
    printf("%d %.17g %.17g %.17g %.17g %.17g\n", status, (double)pose.x, (double)pose.y, (double)pose.yaw,
           (double)after.v, (double)after.omega);
  }
  return 0;
}
"""


@dataclass(frozen=True)
class Window:
    start: float
    end: float
    gx: float = 0.0
    gy: float = 0.0
    drive: tuple[float, float] | None = None

    def line(self) -> str:
        drive = self.drive or (0.0, 0.0)
        known = int(self.drive is not None)
        before = (self.start, self.end, self.gx, self.gy)
        return " ".join((*(repr(float(x)) for x in before), str(known), *(repr(float(x)) for x in drive)))


@dataclass(frozen=True)
class Program:
    """The header, compiled."""

    path: Path

    def run(
        self, commands: Floats, windows: Sequence[Window], capacity: int = 512
    ) -> tuple[list[int], Floats]:
        """Return (refused, kept) commands, and rows of (status, x, y, yaw, v, omega)."""
        rows = [f"{capacity} {len(commands)}", *(" ".join(map(repr, row)) for row in commands.tolist())]
        text = "\n".join([*rows, *(window.line() for window in windows)])
        done = subprocess.run([self.path], input=text, capture_output=True, text=True, check=True, timeout=30)
        first, *lines = done.stdout.splitlines()
        return [int(n) for n in first.split()], np.array([[float(n) for n in line.split()] for line in lines])


Compile = Callable[[Model, str], Program]


@pytest.fixture
def compiled(tmp_path: Path) -> Compile:
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc")

    def build(model: Model, number: str) -> Program:
        exported = export_model(model, "c-header", name="model.yaml")
        (tmp_path / "model.h").write_text(exported.text, encoding="utf-8")
        (tmp_path / "driver.c").write_text(DRIVER, encoding="utf-8")
        define = ["-DSLIPWISE_DOUBLE"] if number == "double" else []
        program = tmp_path / f"driver-{number}"
        command = ["gcc", "-std=c99", *STRICT, *define, "driver.c", "-o", str(program), "-lm"]
        subprocess.run(command, cwd=tmp_path, check=True, timeout=60)
        return Program(program)

    return build


def commands_of(seed: int, *, seconds: float = 12.0) -> Floats:
    """Return held commands at uneven times, which float holds exactly."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.integers(1, 64, 60)) / 64.0
    t = t[t < seconds] - t[0]
    v, omega = rng.uniform(-0.5, 1.5, len(t)), rng.uniform(-1.2, 1.0, len(t))
    return np.column_stack((t, np.round(v * 64.0) / 64.0, np.round(omega * 64.0) / 64.0))


def expected(model: Model, commands: Floats, window: Window) -> Floats:
    model = model.body  # where the robot is, by the clock of the commands
    t, v, omega = (np.ascontiguousarray(column) for column in commands.T)
    given = _core.InputHistory(t, v, np.zeros_like(v), omega)
    drive = window.drive
    history = (
        model.driven(given)
        if drive is None
        else model.driven_from(given, window.start, _core.BodyTwist(drive[0], 0.0, drive[1]))
    )
    segment = _core.Segment(window.start, window.end, _core.Pose2(0.0, 0.0, 0.0), None, window.gx, window.gy)
    if drive is not None:
        held = _core.InputHistory(
            *(np.array([value]) for value in (window.start - 10.0, drive[0], 0.0, drive[1]))
        )
        twist = _core.BodyTwist(drive[0], 0.0, drive[1])
        segment = segment.with_measured_actuator(held, window.start, twist)
    path = _core.integrate_segment(model.motion, model.mean, history, segment, _core.Integrator.Exact)
    return np.asarray(path.poses[-1])


def random_values(basis: _core.Basis, seed: int) -> dict[str, float]:
    rng = np.random.default_rng(seed)
    names = [info.name for info in _core.MotionModel(basis, False, False).parameters]
    return dict(zip(names, rng.uniform(-0.2, 0.2, len(names)).tolist(), strict=True))


OWN = _core.Basis(
    "own", ["V^3*2.5", "gx*0.1"], ["abs(V)*V*w/g", "gy*0.05"], ["sgn(V)*w^2", "kappa*V", "gx*V"]
)
# What slips by the sideways speed is refused: exported files know none.
LEVEL_BASES = [name for name in _core.basis_names() if name != "omni-8"]
BASES = [_core.Basis("none", [], [], []), OWN, *map(_core.named_basis, LEVEL_BASES)]


@pytest.mark.parametrize("number", ["float", "double"])
@pytest.mark.parametrize("basis", BASES, ids=lambda basis: basis.name)
def test_header_predicts_as_slipwise_does(compiled: Compile, basis: _core.Basis, number: str) -> None:
    model = make_model(
        Made(basis, random_values(basis, seed=3), commands=basis.size % 2 == 0, clock_offset=0.05)
    )
    commands = commands_of(seed=basis.size)
    windows = [
        Window(3.0, 8.0),
        Window(0.0, 5.0),
        Window(4.5, 9.5, drive=(0.25, -0.5)),
        Window(5.0, 10.0, gx=1.5, gy=-0.75),
        Window(6.0, 6.0),
        Window(2.0, 2.015625),
    ]
    counts, rows = compiled(model, number).run(commands, windows)
    assert counts == [0, len(commands)]
    assert not rows[:, 0].any()
    poses = np.array([expected(model, commands, window) for window in windows])
    assert np.abs(rows[:, 1:4] - poses).max() < TOLERANCE[number]
    assert np.abs(poses[0]).max() > 0.1


@pytest.mark.parametrize("offset", [None, 0.05, -0.05])
def test_header_has_gain_and_slow_part(compiled: Compile, offset: float | None) -> None:
    made = replace(named("full-linear-6", lon__V=-0.05, lat__w=0.1, ang__w=-0.4), response=True)
    commands = commands_of(seed=21)
    model = make_model(replace(made, clock_offset=offset))
    windows = [Window(4.0, 9.0), Window(3.0, 8.0, drive=(0.4, -0.3)), Window(5.0, 5.03, drive=(0.4, 0.3))]
    _, rows = compiled(model, "double").run(commands, windows)
    poses = np.array([expected(model, commands, window) for window in windows])
    assert np.abs(rows[:, 1:4] - poses).max() < TOLERANCE["double"]
    plain = make_model(replace(made, response=False, commands=True, clock_offset=offset))
    assert np.abs(expected(plain, commands, windows[0]) - poses[0]).max() > 0.05


@pytest.mark.parametrize("number", ["float", "double"])
@pytest.mark.parametrize("response", [False, True])
def test_header_of_a_robot_that_steers(compiled: Compile, response: bool, number: str) -> None:
    made = named("odd-even-10", lon__V=-0.05, lat__w=0.1, ang__w=-0.4)
    made = replace(made, commands=True, response=response)
    model = make_model(replace(made, wheelbase=0.5))
    commands = commands_of(seed=21)
    commands[::7, 1:] = (0.0, 0.0)  # it stands with straight wheels, and with turned ones
    commands[3::7, 1:] = (_core.STANDING_SPEED, 0.7 * _core.STANDING_SPEED)
    windows = [Window(4.0, 9.0), Window(3.0, 8.0, drive=(0.4, -0.3)), Window(6.0, 7.5, drive=(0.05, 0.3))]
    windows += [Window(0.0, 5.0, drive=drive) for drive in (None, (0.4, -0.3), (0.05, 0.3))]
    _, rows = compiled(model, number).run(commands, windows)
    poses = np.array([expected(model, commands, window) for window in windows])
    assert not rows[:, 0].any()
    assert np.abs(rows[:, 1:4] - poses).max() < TOLERANCE[number]
    assert np.abs(expected(make_model(made), commands, windows[0]) - poses[0]).max() > 0.05


@pytest.mark.parametrize("delays", [(0.23, 0.11), (0.0, -0.02)])
def test_header_has_delays_without_an_actuator_model(compiled: Compile, delays: tuple[float, float]) -> None:
    model = make_model(replace(named("full-linear-6", lat__w=0.1, ang__w=-0.4), delays=delays))
    commands = commands_of(seed=21)
    windows = [Window(4.0, 9.0), Window(0.0, 5.0), Window(3.0, 8.0, drive=(0.4, -0.3)), Window(5.0, 5.03)]
    _, rows = compiled(model, "double").run(commands, windows)
    poses = np.array([expected(model, commands, window) for window in windows])
    assert np.abs(rows[:, 1:4] - poses).max() < TOLERANCE["double"]


@pytest.mark.parametrize("lanes", [(), ("speed", "yaw_rate"), ("side",)], ids=["free", "ramps", "sides"])
@pytest.mark.parametrize("fraction", [0.0, 0.14, 0.8])
def test_header_goes_from_a_measured_speed_to_the_command_and_not_beyond(
    compiled: Compile, fraction: float, lanes: tuple[str, ...]
) -> None:
    rates = {lane: {"slew_rate_up": 0.8, "slew_rate_down": 1.7} for lane in lanes}
    values = {"slow_fraction_v": fraction, "gain_v": 0.8, "log_slow_time_constant_v": 1.0}
    model = make_model(Made(_core.Basis("none", [], [], []), values, response=True, limits=rates or None))
    program = compiled(model, "double")
    commands = np.array([(t, 1.0, 0.0) for t in np.arange(0.0, 6.0, 0.25)])
    goal = 0.8 * (1.1 if "side" in lanes else 1.0)  # limited sides come with a gain of their own
    for start, part in product((0.0, 0.125, 0.5, 2.0), (0.0, 0.3, 1.0)):
        ends = start + np.arange(1, 31) / 10.0
        windows = [Window(start, float(end), drive=(part * goal, 0.0)) for end in ends]
        _, rows = program.run(commands, windows)
        poses = np.array([expected(model, commands, window) for window in windows])
        assert rows[:, 1:4] == pytest.approx(poses, abs=TOLERANCE["double"])
        speed = np.diff(rows[:, 1], prepend=0.0) / 0.1
        assert speed.min() >= -1e-9
        assert speed.max() <= goal + 1e-9
        if part == 1.0:
            assert speed == pytest.approx(np.full(len(speed), goal), abs=1e-9)


@pytest.mark.parametrize("number", ["float", "double"])
@pytest.mark.parametrize("lag", [{}, {"slew_rate_lag": 0.2}], ids=["in front", "behind a lag"])
@pytest.mark.parametrize("lanes", ["speed", "yaw_rate", "side", "all"])
def test_header_puts_commands_behind_limits(
    compiled: Compile, lanes: str, lag: Mapping[str, float], number: str
) -> None:
    made = replace(named("full-linear-6", lon__V=-0.05, lat__w=0.1, ang__w=-0.4), response=lanes == "all")
    limits = {lane: {**kinds, **lag} for lane, kinds in LIMITS.items() if lanes in (lane, "all")}
    commands = commands_of(seed=21)
    windows = [Window(4.0, 9.0), Window(0.0, 5.0), Window(3.0, 8.0, drive=(0.4, -0.3)), Window(5.0, 5.03)]
    for offset in (None, -0.05):
        model = make_model(replace(made, commands=True, clock_offset=offset, limits=limits))
        _, rows = compiled(model, number).run(commands, windows)
        poses = np.array([expected(model, commands, window) for window in windows])
        assert not rows[:, 0].any()
        assert np.abs(rows[:, 1:4] - poses).max() < TOLERANCE[number]
    free = make_model(replace(made, commands=True, clock_offset=offset))
    assert np.abs(expected(free, commands, windows[0]) - poses[0]).max() > 0.05


@pytest.mark.parametrize("number", ["float", "double"])
def test_header_agrees_with_predict_along_a_path(compiled: Compile, number: str) -> None:
    made = named(
        "odd-even-10", lon__V=-0.08, lat__w=0.07, ang__w=-0.5, ang__V=-0.04, log_time_constant_v=-2.06
    )
    model = make_model(replace(made, commands=True))
    commands = commands_of(seed=11)
    path = predict(model, commands, horizon=5.0, start=2.0)
    windows = [Window(2.0, t) for t in path.t.tolist()]
    _, rows = compiled(model, number).run(commands, windows)
    assert np.abs(rows[:, 1:4] - path.poses).max() < TOLERANCE[number]


def test_the_drive_at_the_end_starts_the_next_window(compiled: Compile) -> None:
    model = make_model(replace(named("edd-2", lon__V=-0.1, ang__w=-0.4), commands=True))
    commands, program = commands_of(seed=5), compiled(model, "double")
    _, (first, whole) = program.run(commands, [Window(2.0, 4.0), Window(2.0, 6.0)])
    _, (second,) = program.run(commands, [Window(4.0, 6.0, drive=(first[4], first[5]))])
    joined = _core.compose(_core.Pose2(*first[1:4]), _core.Pose2(*second[1:4])).vector()
    assert np.allclose(joined, whole[1:4], atol=1e-3)  # steps of 0.1 s are cut elsewhere
    assert np.allclose(second[4:], whole[4:], atol=1e-12)


def test_a_full_ring_forgets_the_oldest_commands(compiled: Compile) -> None:
    model = make_model(replace(named("edd-2", ang__w=-0.4), commands=True))
    commands, program = commands_of(seed=6), compiled(model, "double")
    window = Window(commands[-1, 0], commands[-1, 0] + 5.0)
    counts, (kept,) = program.run(commands, [window], capacity=16)
    assert counts == [0, 16]
    assert np.allclose(kept[1:4], expected(model, commands[-16:], window), atol=1e-9)


def test_wrong_windows_and_commands_get_a_status_and_no_pose(compiled: Compile) -> None:
    program = compiled(make_model(named("edd-2")), "float")
    commands = np.array(
        [[1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.5, 1.0, 0.0], [2.0, np.nan, 0.0], [3.0, 1.0, np.inf]]
    )
    windows = [
        Window(2.0, 1.0),
        Window(np.nan, 3.0),
        Window(2.0, 3e7),
        Window(2.0, 3.0, gx=np.inf),
        Window(2.0, 3.0, drive=(np.nan, 0.0)),
        Window(0.5, 3.0),
    ]
    counts, rows = program.run(commands, windows)
    assert counts == [4, 1]
    assert rows[:, 0].tolist() == [1, 1, 1, 1, 1, 2]
    assert not rows[:, 1:].any()


@pytest.mark.parametrize("define", [[], ["-DSLIPWISE_DOUBLE"]], ids=["float", "double"])
@pytest.mark.parametrize("limits", [None, LIMITS], ids=["free", "limited"])
def test_header_is_also_cpp(
    tmp_path: Path, define: list[str], limits: dict[str, dict[str, float]] | None
) -> None:
    if shutil.which("g++") is None:
        pytest.skip("there is no g++")
    model = make_model(Made(OWN, random_values(OWN, seed=1), commands=True, limits=limits))
    (tmp_path / "model.h").write_text(export_model(model, "c-header", name="m.yaml").text, encoding="utf-8")
    (tmp_path / "use.cpp").write_text('#include "model.h"\n#include "model.h"\nint main() { return 0; }\n')
    command = ["g++", "-std=c++11", *STRICT, "-Wconversion", "-Wshadow", *define, "use.cpp", "-o", "use"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=60)


def test_constants_are_those_of_the_model_to_the_last_bit() -> None:
    model = make_model(
        replace(named("edd-2", lon__V=-0.1, ang__w=1.0 / 3.0), commands=True, clock_offset=0.07)
    )
    text = c_header(model, ["origin"])
    defines = [line.split() for line in text.splitlines() if line.startswith("#define SLIPWISE_")]
    words = {words[1]: words[2] for words in defines if len(words) > 2}

    def number(name: str) -> float:
        return float(words[f"SLIPWISE_{name}"].removeprefix("SLIPWISE_R(").removesuffix(")"))

    actuator = model.motion.actuator(model.mean)
    assert [number("P0"), number("P1")] == [-0.1, 1.0 / 3.0]
    assert number("TIME_CONSTANT_V") == actuator.time_constant_v
    assert number("DELAY_OMEGA") == actuator.delay_omega
    assert "CLOCK_OFFSET" not in text, "the robot is where it is, whenever its poses are stamped"
    assert [number("SPEED_MIN"), number("SPEED_MAX")] == model.content.range.speed


def test_a_chain_that_the_header_does_not_know_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    model = make_model(replace(named("edd-2"), commands=True))
    monkeypatch.setattr("slipwise.export.actuator._KNOWN", {"log_time_constant_v"})
    with pytest.raises(ModelError, match=r"the actuator model has log_delay_omega, .* cannot be exported"):
        c_header(model, [])
