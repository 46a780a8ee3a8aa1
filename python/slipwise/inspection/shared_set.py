# SPDX-License-Identifier: Apache-2.0
"""Writes what goes beside a shared log: its schema file, its data card, and the windows to predict."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from slipwise.evaluation import EvaluationOptions, evaluate, write_predictions
from slipwise.files import write_text_whole
from slipwise.inspection.data_card import Stated, card_path, make_card, write_card
from slipwise.inspection.inspect_log import inspect_log
from slipwise.inspection.strict_check import schema_of, schema_path
from slipwise.logs import open_log
from slipwise.logs.table import read_parquet


def windows_path(table: Path) -> Path:
    """Where the windows to predict are: the predictions of the baseline, as a prediction file."""
    return table.with_name(f"{table.stem}.windows.csv")


def files_beside(table: Path) -> dict[str, Path]:
    """All files of a shared log but the table, by what they are."""
    return {"schema": schema_path(table), "card": card_path(table), "windows": windows_path(table)}


def write_beside(
    table: Path, stated: Stated, *, anonymised: bool, progress: Callable[[str, float], None]
) -> None:
    """Read a table back, learn from it as `inspect` does, and write the files that go beside it.

    Raises:
        LogError: nothing in the table can be predicted.
        OutputError: a file cannot be written.
    """
    log = open_log(table)
    progress("learning", 0.3)
    card = make_card(table, inspect_log(log), stated, anonymised=anonymised)
    progress("windows", 0.8)
    windows = evaluate(log, options=EvaluationOptions(methods=("none",)))
    schema = schema_of(read_parquet(table, columns={}))
    write_text_whole(schema_path(table), json.dumps(schema, indent=2, ensure_ascii=False) + "\n")
    write_predictions(windows_path(table), windows)
    write_card(card, card_path(table))
