# SPDX-License-Identifier: Apache-2.0
"""Each fault of wiring is found in each log that it is put into, and none in logs of sound robots."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from contradictory_logs import SKID_STEERED, sound_log
from faulty_logs import found_in, not_found

from slipwise.logs import Log, LogOptions, open_log
from slipwise.logs.findings.checks import EVERY
from slipwise.logs.findings.diagnose import diagnose_log
from slipwise.logs.findings.finding import FAMILIES

REAL = (
    "husky/tile_deflated_tyres",
    "warthog/grass_7_29_14h46s15",
    "warthog/grass_8_8_15h56s39",
    "warthog/asphalt_9_25_12h8s57",
    "f1tenth/DS3",
    "create/MRCLAM6_R1",
)
#: What is true of these logs, and therefore found.
TRUE = {
    "LVMS_23_01_04_B": {"echoed-commands"},  # its commands are the speed of the rear wheels
    "dart_rubbery_floor": {"does-not-move"},  # its throttle acts only where a safety switch is on
    "dart_steering_steps_rubbery": {"does-not-move"},  # the same
    "husky_weak_motors": {"does-not-move"},  # at its end the wheels turn at 0.5 m/s and the poses stand
}


def real_log(path: Path) -> Log:
    options: dict[str, Any] = {"f1tenth": {"wheelbase": 0.32}}.get(path.parent.name, {})
    if path.name.startswith("dart"):
        options = {"vehicle": "dart"}
    return open_log(path, options=LogOptions.of(options))


def test_each_fault_is_found_in_a_simulated_drive() -> None:
    log = sound_log(replace(SKID_STEERED, seconds=150.0))
    assert found_in(log) == ()
    assert not_found(log) == []


@pytest.mark.slow
def test_each_fault_is_found_in_real_logs(real_log_dir: Path) -> None:
    missed = []
    for name in REAL:
        missed += not_found(real_log(real_log_dir / f"{name}.csv.gz"), name.split("/")[1])
    assert missed == []


@pytest.mark.slow
def test_nothing_false_is_found_in_a_real_log(real_log_dir: Path) -> None:
    beside = real_log_dir.parent
    paths = [
        *real_log_dir.glob("*/*.csv.gz"),
        *beside.glob("vehicles/*.csv.gz"),
        *beside.glob("foreign/*/*.csv.gz"),
    ]
    without = ("comma2k19",)  # no yaw rate beside its speed
    found = {}
    for path in sorted(each for each in paths if not each.name.startswith(without)):
        kinds = {each.kind for each in diagnose_log(real_log(path))}
        if kinds:
            found[path.name.removesuffix(".csv.gz")] = kinds
    assert found == {name: kinds for name, kinds in TRUE.items() if any(name in p.name for p in paths)}


def test_each_check_says_what_it_is() -> None:
    for check in EVERY:
        assert check.family in FAMILIES
        assert all(text and "|" not in text for text in (check.means, check.shows, check.cure))
