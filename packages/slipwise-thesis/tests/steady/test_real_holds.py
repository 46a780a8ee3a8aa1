# SPDX-License-Identifier: Apache-2.0
"""A real Husky's 200 held commands of 6 s: chapter 4's experiment, driven by others."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipwise.logs import open_log
from slipwise_thesis.steady import (
    GroupRules,
    SlipFitRules,
    compare_fits,
    cut_paths,
    find_holds,
    fit_group_noise,
    group_paths,
    slip_table,
)


def test_held_commands_of_a_husky_give_the_slip_of_a_skid_steered_robot(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "husky" / "tile_deflated_tyres.csv.gz")
    paths = []
    holds = 0
    for run in log.runs:
        assert run.commands is not None
        holds += len(find_holds(run.commands))
        paths += cut_paths(run, run.commands).paths
    assert holds == 200
    assert len(paths) >= 195
    groups = group_paths(paths, GroupRules(speed=0.1, curvature=0.2, yaw_rate=0.3))
    assert any(group.curvature is None for group in groups)
    found = fit_group_noise(groups)
    assert np.all(found.noise.psd > 0.0)
    rows = slip_table(groups, SlipFitRules(noise=found.noise))
    assert len(rows) == len(groups)
    turning = np.array([(row.omega, row.slip[2]) for row in rows])
    slope, offset = np.polyfit(turning[:, 0], turning[:, 1], 1)
    assert -0.65 < slope < -0.4  # about half of the commanded turn is lost on tile
    assert abs(offset) < 0.02
    assert np.corrcoef(turning.T)[0, 1] < -0.99


def test_three_channels_explain_what_translation_cannot_on_a_husky(real_log_dir: Path) -> None:
    (run, *_) = open_log(real_log_dir / "husky" / "tile_deflated_tyres.csv.gz").runs
    assert run.commands is not None
    groups = group_paths(
        cut_paths(run, run.commands).paths, GroupRules(speed=0.1, curvature=0.2, yaw_rate=0.3)
    )
    comparisons = [compare_fits(group) for group in groups if len(group) >= 3 and abs(group.omega) > 0.2]
    assert len(comparisons) >= 5
    for comparison in comparisons:
        assert comparison.curve("translation").cost > 3.0 * comparison.curve("three channels").cost
