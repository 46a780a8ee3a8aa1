# SPDX-License-Identifier: Apache-2.0
"""A Dask cluster learns all logs; a worker that is killed loses none."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest
from fleet.work_samples import DIES_ONCE, FAILS, sample_task, sample_work

from slipwise.errors import SettingsError
from slipwise.fleet.dask_scheduler import DaskScheduler

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(find_spec("distributed") is None, reason="the extra `fleet` is not installed"),
]


def test_killed_worker_costs_nothing_but_its_log_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import distributed

    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).resolve().parents[1]))  # of the workers
    names = [*(f"log-{k}" for k in range(6)), str(tmp_path / DIES_ONCE), FAILS]
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        scheduler = DaskScheduler(cluster.scheduler_address, work=sample_work)
        outcomes = {outcome.task.path: outcome for outcome in scheduler.run(map(sample_task, names))}
    assert sorted(outcomes) == sorted(names)
    assert (tmp_path / f"{DIES_ONCE}.died").exists()
    assert outcomes[str(tmp_path / DIES_ONCE)].rows is not None
    assert outcomes[FAILS].failure == "ValueError: as it was told"


def test_address_without_a_scheduler_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("slipwise.fleet.dask_scheduler.PATIENCE", 0.5)
    with pytest.raises(SettingsError, match="no Dask scheduler"):
        DaskScheduler("tcp://127.0.0.1:9")
