# SPDX-License-Identifier: Apache-2.0
"""Generated logs can be learned, differ in their bytes, and stand by vehicle and day."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from fleet_logs import DAY, FIRST, moved, write_logs

from slipwise.fleet.learned_rows import log_hash
from slipwise.logs import open_log, save_log


def test_simulated_logs_differ_and_are_of_vehicles_and_days(tmp_path: Path) -> None:
    paths = list(write_logs(tmp_path, 21, 5.0, None))
    assert len({log_hash(path) for path in paths}) == 21
    assert [path.parent.name for path in (paths[0], paths[19], paths[20])] == [
        "simulated-00",
        "simulated-19",
        "simulated-00",
    ]
    assert open_log(paths[0]).runs[0].span[0] == FIRST
    assert open_log(paths[20]).runs[0].span[0] == FIRST + DAY


def test_every_other_log_is_a_real_one_on_another_day(tmp_path: Path) -> None:
    (tmp_path / "real" / "husky").mkdir(parents=True)
    (first,) = write_logs(tmp_path / "one", 1, 5.0, None)
    original = open_log(first)
    save_log(original, tmp_path / "real" / "husky" / "grass.csv.gz")
    paths = list(write_logs(tmp_path / "all", 4, 5.0, tmp_path / "real"))
    assert [path.parent.name for path in paths] == [
        "simulated-00",
        "husky-grass",
        "simulated-01",
        "husky-grass",
    ]
    for path, days in ((paths[1], 1), (paths[3], 2)):
        np.testing.assert_allclose(open_log(path).runs[0].poses.x, original.runs[0].poses.x)
        assert open_log(path).runs[0].span[0] == FIRST + days * DAY


def test_moved_log_keeps_all_but_its_time(tmp_path: Path) -> None:
    (path,) = write_logs(tmp_path, 1, 5.0, None)
    log = open_log(path)
    run, later = log.runs[0], moved(log, 10.0).runs[0]
    assert run.wheels is not None
    assert later.wheels is not None
    np.testing.assert_allclose(later.wheels.t, run.wheels.t + 10.0)
    np.testing.assert_array_equal(later.wheels.v, run.wheels.v)
