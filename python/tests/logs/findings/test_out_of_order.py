# SPDX-License-Identifier: Apache-2.0
"""Rows out of order are left out, counted and said alike: of a table, of a bag, and line by line."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log

import slipwise.logs.write_bag as mcap
from slipwise.calibration import calibrate
from slipwise.live.recent_log import RecentLog
from slipwise.logs import Log, LogOptions, open_log, save_log
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.out_of_order import OutOfOrder
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.row_reader import RowReader
from slipwise.models.slip_words import slip_gains

LOG = sound_log(replace(SKID_STEERED, seconds=120.0))


def shuffled(folder: Path, rows: int) -> Path:
    """The drive as a table whose rows are displaced by some, at random."""
    save_log(LOG, folder / "sorted.csv")
    head, *body = (folder / "sorted.csv").read_text(encoding="utf-8").splitlines()
    places = np.arange(len(body)) + np.random.default_rng(2).uniform(0.0, rows, len(body))
    path = folder / f"shuffled-{rows}.csv"
    path.write_text(
        "\n".join([head, *(body[k] for k in np.argsort(places, kind="stable"))]), encoding="utf-8"
    )
    return path


def found_in(log: Log) -> Finding | None:
    return OutOfOrder().look_at(WholeLog(log, "wheel"))


@pytest.mark.parametrize("rows", [3, 6, 20])
def test_shuffled_rows_are_said_with_how_many_are_left_out(tmp_path: Path, rows: int) -> None:
    log = open_log(shuffled(tmp_path, rows))
    (run,) = log.runs
    assert run.wheels is not None
    lost = 2400 - len(run.wheels)
    assert {entry.count for entry in log.left_out if entry.reason.startswith("wheels")} == {lost}
    found = found_in(log)
    assert found is not None
    assert found.reserves
    assert found.sentence.startswith(f"{lost} of 2400 ")
    assert found.evidence == pytest.approx(lost / 2400)


def test_what_is_kept_of_shuffled_rows_is_right_and_is_said_with_reservations(tmp_path: Path) -> None:
    result = calibrate(open_log(shuffled(tmp_path, 6)), input="wheel")
    assert "earlier than one that came before them" in str(result.verdict)
    gains = slip_gains(result.model)
    assert gains.speed.value == pytest.approx(0.95, abs=3.0 * gains.speed.std)
    assert gains.yaw_rate.value == pytest.approx(0.6, abs=3.0 * gains.yaw_rate.std)


def test_lines_and_messages_out_of_order_are_said_as_rows_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = shuffled(tmp_path, 6)
    recent, reader = RecentLog("wheel", 0.5), RowReader(LogOptions())
    for row in csv.DictReader(path.read_text(encoding="utf-8").splitlines()):
        for sample in reader.read({name: cell for name, cell in row.items() if cell}, list(row)).measurements:
            recent.take(sample)
        recent.found()
    assert "out-of-order" in {each.kind for each in recent.found()}

    def write(entries: list[mcap.Entry], temporary: Path, make: mcap._Messages) -> None:
        """Messages that arrive one after the other, in the order of the rows."""
        rng, (run, *rest) = np.random.default_rng(2), entries
        places = np.argsort(np.arange(len(rest)) + rng.uniform(0.0, 18.0, len(rest)), kind="stable")
        arrived = [(rest[k][0], *rest[place][1:]) for k, place in enumerate(places.tolist())]
        written(([run, *arrived]), temporary, make)

    written = mcap._write
    monkeypatch.setattr(mcap, "_write", write)
    save_log(LOG, tmp_path / "shuffled.mcap")
    assert found_in(open_log(tmp_path / "shuffled.mcap")) is not None


def test_a_few_late_rows_are_only_counted(tmp_path: Path) -> None:
    save_log(LOG, tmp_path / "sorted.csv")
    lines = (tmp_path / "sorted.csv").read_text(encoding="utf-8").splitlines()
    for k in range(100, 2000, 100):
        lines[k], lines[k + 1] = lines[k + 1], lines[k]
    (tmp_path / "late.csv").write_text("\n".join(lines), encoding="utf-8")
    log = open_log(tmp_path / "late.csv")
    assert {entry.count for entry in log.left_out} == {19}
    assert found_in(log) is None
    assert found_in(open_log(tmp_path / "sorted.csv")) is None
