# SPDX-License-Identifier: Apache-2.0
"""A Ray of this machine learns all logs; a worker that is killed loses none."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from fleet.work_samples import DIES, DIES_ONCE, FAILS, sample_task, sample_work

from slipwise.errors import SettingsError, SlipwiseError
from slipwise.fleet.ray_scheduler import RAY, RayScheduler
from slipwise.fleet.scheduler import DIED


@pytest.mark.slow
def test_killed_worker_costs_nothing_but_its_log_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("ray", reason="the extra `ray` is not installed")
    monkeypatch.delenv("RAY_ADDRESS", raising=False)
    monkeypatch.setenv("RAY_AUTH_MODE", "disabled")
    found = [str(Path(__file__).resolve().parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(found))  # of the workers
    names = [*(f"log-{k}" for k in range(6)), str(tmp_path / DIES_ONCE), DIES, FAILS]
    scheduler = RayScheduler(RAY, work=sample_work)
    outcomes = {outcome.task.path: outcome for outcome in scheduler.run(map(sample_task, names))}
    assert sorted(outcomes) == sorted(names)
    assert (tmp_path / f"{DIES_ONCE}.died").exists()
    assert outcomes[str(tmp_path / DIES_ONCE)].rows is not None
    assert all(outcomes[f"log-{k}"].rows is not None for k in range(6))
    assert outcomes[DIES].failure == DIED
    assert outcomes[FAILS].failure == "ValueError: as it was told"


@pytest.mark.slow
def test_address_without_a_cluster_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    client = pytest.importorskip("ray.util.client.worker", reason="the extra `ray` is not installed")
    monkeypatch.setattr(client, "INITIAL_TIMEOUT_SEC", 0.1)
    monkeypatch.setattr(client, "MAX_TIMEOUT_SEC", 0.1)
    with pytest.raises(SettingsError, match=r"no Ray cluster answers: .*connection timeout"):
        RayScheduler("ray://127.0.0.1:9")


def test_missing_ray_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(SlipwiseError, match=r"slipwise\[ray\]"):
        RayScheduler(RAY)
