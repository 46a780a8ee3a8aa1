# SPDX-License-Identifier: Apache-2.0
"""A log that contradicts itself ends with exit code 1, the likely cause and the option that cures it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Columns, Result, write_csv

Slipwise = Callable[..., Result]
QUICK = ("--basis", "edd-2", "--no-report")


def learn(slipwise: Slipwise, columns: Columns, *options: str) -> Result:
    return slipwise("calibrate", write_csv(Path("drive.csv"), columns), *QUICK, *options)


def test_a_stopped_robot(slipwise: Slipwise, columns: Columns) -> None:
    noise = 0.01 * np.random.default_rng(1).standard_normal((3, len(columns["t"])))
    for name, jitter in zip(("x", "y", "yaw"), noise, strict=True):
        columns[name] = jitter
    result = learn(slipwise, columns, "--input", "command")
    assert (result.code, result.err) == (1, "")
    assert "the robot does not move although it is commanded" in result.out
    assert "Turns " not in result.out


@pytest.mark.parametrize(
    ("name", "factor", "cure"),
    [
        ("cmd_v", 1.0 / 0.15, ("--input", "command", "--command-scale", "0.15,1")),
        ("odo_v", -1.0, ("--input", "wheel", "--wheel-scale", "-1,1")),
        ("yaw", np.pi, ("--input", "wheel", "--pose-yaw-offset", "-3.14159265")),
        ("yaw", 0.5 * np.pi, ("--input", "wheel", "--pose-yaw-offset", "-1.57079633")),
    ],
)
def test_units_signs_and_frames_are_cured_by_the_option_that_is_named(
    slipwise: Slipwise, columns: Columns, name: str, factor: float, cure: tuple[str, ...]
) -> None:
    columns[name] = columns[name] + factor if name == "yaw" else columns[name] * factor
    bad = learn(slipwise, columns, *cure[:2])
    assert bad.code == 1
    assert cure[2] in bad.out
    good = learn(slipwise, columns, *cure)
    assert good.code == 0
    assert "as given" in good.out


def test_a_heading_that_makes_the_position_worse_is_not_good(slipwise: Slipwise, columns: Columns) -> None:
    half = columns["t"] > 45.0
    columns["yaw"] = columns["yaw"] + np.pi * half
    result = learn(slipwise, columns, "--input", "wheel")
    assert result.code == 1
    assert "the heading of the poses jumps by 180 deg" in result.out


@pytest.mark.parametrize("text", ["a,1", "0.15", "0,1", "1,2,3"])
def test_a_scale_that_is_none_is_refused_in_one_line(slipwise: Slipwise, columns: Columns, text: str) -> None:
    result = learn(slipwise, columns, "--command-scale", text)
    assert result.code == 2
    assert "0.15,1" in result.line
