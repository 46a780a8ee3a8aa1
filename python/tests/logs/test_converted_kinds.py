# SPDX-License-Identifier: Apache-2.0
"""A converted log is the same log, or what its format cannot hold is named and counted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from sample_kinds import Kind, kinds

from slipwise.calibration.surface_labels import labels_of
from slipwise.errors import LogError
from slipwise.logs import Log, LogOptions, Run, open_log, save_log
from slipwise.logs.readings import READINGS
from slipwise.segments import force_rows, reading_rows, recording_rows, sourced_rows

STREAMS = ("commands", "wheels", "attitudes", "poses", "forces", *(kind.column for kind in READINGS))


def streams(run: Run) -> dict[str, np.ndarray]:
    commands, wheels, attitudes, poses = recording_rows(run)
    sourced = sourced_rows(run, poses, (run.source, *run.others))
    return dict(
        zip(
            STREAMS,
            (commands, wheels, attitudes, sourced, force_rows(run), *reading_rows(run).values()),
            strict=True,
        )
    )


def lost(before: Log, after: Log, most: float) -> dict[str, int]:
    """How many samples of each stream are not there any more, or are others."""
    found = dict.fromkeys((*STREAMS, "labels"), 0)
    assert [run.name for run in before.runs] == [run.name for run in after.runs]
    for old, new in zip(before.runs, after.runs, strict=True):
        now = streams(new)
        for name, rows in streams(old).items():
            same = rows.shape == now[name].shape and np.allclose(
                rows, now[name], rtol=0.0, atol=most, equal_nan=True
            )
            found[name] += 0 if same else len(rows)
        found["labels"] += 0 if labels_of(old) == labels_of(new) else len(labels_of(old))
    return {name: count for name, count in found.items() if count}


def difference(kind: Kind, folder: Path, ending: str) -> str:
    """Say what a conversion loses without a word; empty where nothing is."""
    path, options = kind.read(folder)
    log, target = open_log(path, options=options), folder / f"converted{ending}"
    try:
        left_out = save_log(log, target)
    except LogError as refused:
        return "" if ending == ".mcap" and ".csv or .parquet" in str(refused) else str(refused)
    again = LogOptions(vehicle=options.vehicle if options.car is not None else None)
    gone = lost(log, open_log(target, options=again), 0.0 if ending != ".mcap" else 1e-6)
    if ending == ".mcap":
        return "" if not gone or left_out else str(gone)
    return "" if not gone and not left_out else f"{gone} {left_out}"


def test_every_kind_of_log_converts_to_every_format(tmp_path: Path) -> None:
    found = {}
    for name, kind in kinds().items():
        (tmp_path / name).mkdir()
        for ending in (".csv", ".csv.gz", ".parquet", ".mcap"):
            found[name, ending] = difference(kind, tmp_path / name, ending)
    assert {each: said for each, said in found.items() if said} == {}


def test_a_bag_says_what_it_does_not_hold(tmp_path: Path) -> None:
    path, options = kinds()["two sources"].read(tmp_path)
    left_out = save_log(open_log(path, options=options), tmp_path / "b.mcap")
    assert [(each.count, each.kind) for each in left_out] == [(150, "not-written")]
    assert "poses of the source mocap" in left_out[0].reason
