# SPDX-License-Identifier: Apache-2.0
"""What a learner says of the surfaces of a sequence."""

from __future__ import annotations

from sample_logs import Drive, simulated_log

from slipwise.calibration.learned_sequence import learn_sequence
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings import Settings


def test_one_surface_all_the_time_is_one_surface() -> None:
    drives = [prepare_run(simulated_log(Drive(seconds=60.0, seed=seed)), "wheel") for seed in range(3)]
    done: list[float] = []
    learned = learn_sequence(drives, Settings(), (1.0,), progress=done.append)
    assert len(learned.surfaces) == 1
    assert learned.surfaces[0].visits == 3
    assert learned.surfaces[0].seconds > 150.0
    assert learned.surfaces[0].speed > 0.0
    assert [log.surface for log in learned.logs] == ["surface 1"] * 3
    assert any(change.what == "recalled" for change in learned.logs[1].changes)
    assert done[-1] == 1.0
    assert done == sorted(done)
