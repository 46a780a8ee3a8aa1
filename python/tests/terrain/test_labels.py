# SPDX-License-Identifier: Apache-2.0
"""The table of labels has a row for each window that has one."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from slipwise.terrain import Answer, Windows, write_labels


def test_a_row_for_each_label_with_names_quoted_where_they_must_be(tmp_path: Path) -> None:
    names = np.array(["a", 'b,"c"', "d"], dtype=object)
    start = np.array([0.0, 5.0, 10.0])
    windows = Windows(names, start, start + 5.0, names, np.empty((3, 0)), np.empty((3, 0)))
    probability = np.array([[0.75, 0.25], [np.nan, np.nan], [0.1, 0.9]])
    answer = Answer(("ice", "wet, grass"), names, probability, np.array([0.125, np.nan, 0.5]))
    labels = np.array(["ice", "", "unknown"], dtype=object)
    path = write_labels(tmp_path / "labels.csv", windows, answer, labels)
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows == [
        ["run", "t_start", "t_end", "label", "p_ice", "p_wet, grass", "p_unknown"],
        ["a", "0.000", "5.000", "ice", "0.7500", "0.2500", "0.1250"],
        ["d", "10.000", "15.000", "unknown", "0.1000", "0.9000", "0.5000"],
    ]
