# SPDX-License-Identifier: Apache-2.0
"""Cells that slipwise refuses on purpose, and cells that are wrong today; all others are right."""

from __future__ import annotations

from collections.abc import Callable

from matrix.situation import Situation

#: Which situations are refused in which uses, and what the refusal says.
REFUSED: tuple[tuple[Callable[[Situation], bool], str, str], ...] = (
    (lambda s: s.robot.kind == "throttle", "trajectory c-header excite to-", "throttle and steering"),
    (lambda s: s.robot.kind == "steering", "to-diff-drive", "has no diff_drive_controller"),
    (lambda s: s.axes == 3, "to-", "have no sideways speed"),
    (lambda s: s.learns == "wheel", "to-mppi", "was not learned from commands"),
    (lambda s: s.learns == "wheel", "excite", "nothing from commands"),
    (lambda s: s.learns == "command", "to-diff-drive to-amcl to-autoware", "calibrate with `--input wheel`"),
    (lambda s: "positions" in s.name, "mcap", "positions without headings are not written as a bag"),
    (lambda s: s.before is not None, "several-logs", "has no wheel input"),
    (lambda s: s.turns, "several-logs", "no run of the log has both"),
    (lambda s: s.name == "throttle-gyro", "calibrate", "cannot be learned from yaw rates alone"),
    (lambda s: s.name == "force-world", "rollout mppi trajectory excite", "know no heading over the map"),
    (lambda s: any("estimator=" in each for each in s.settings), "replay lines pushed ahead", "whole logs"),
    (lambda s: s.robot.kind == "throttle", "mcap", "throttle and steering are not written as a bag"),
    (lambda s: s.name in ("gyro", "gyro-commands"), "mcap", "turns of a gyro alone are not written as a bag"),
)

#: Cells that are wrong, by why they are; a test turns up when its cell is mended.
WRONG: dict[str, str] = {}


def refusal(situation: Situation, use: str) -> str | None:
    """Return what the refusal of a cell says; None where it is not refused."""
    for applies, uses, said in REFUSED:
        if applies(situation) and any(
            use == each or (each[-1] == "-" and use.startswith(each)) for each in uses.split()
        ):
            return said
    return None


def why_wrong(situation: Situation, use: str) -> str | None:
    """Return why a cell is wrong; None where it is not."""
    cell = f"{situation.name}:{use}"
    return next((why for why, cells in WRONG.items() if cell in cells.split()), None)
