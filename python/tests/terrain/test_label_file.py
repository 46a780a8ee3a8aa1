# SPDX-License-Identifier: Apache-2.0
"""Tables of labels are read by run and time; what is no probability is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.terrain import Answer, Windows, read_labels, write_labels
from slipwise.terrain.label_file import is_label_file


def written(folder: Path, text: str) -> Path:
    path = folder / "labels.csv"
    path.write_text(text)
    return path


def test_what_classify_writes_comes_back_in_the_order_of_time(tmp_path: Path) -> None:
    runs, start = np.array(["b", "a", "a"], dtype=object), np.array([0.0, 5.0, 0.0])
    windows = Windows(runs, start, start + 5.0, np.full(3, ""), np.zeros((3, 0)), np.zeros((3, 16)))
    odds = np.array([[0.7, 0.3], [0.2, 0.8], [0.6, 0.4]])
    answer = Answer(("ice", "sand"), np.full(3, "current", dtype=object), odds, np.array([0.1, 0.9, 0.2]))
    labels = np.array(["ice", "unknown", "ice"], dtype=object)
    found = read_labels([write_labels(tmp_path / "labels.csv", windows, answer, labels)])
    assert sorted(found) == ["a", "b"]
    assert [window.end for window in found["a"]] == [5.0, 10.0]
    assert found["a"][1].answer.classes == ["ice", "sand"]
    np.testing.assert_allclose(found["a"][1].answer.probability, [0.2, 0.8])
    assert found["a"][1].answer.unknown == 0.9


def test_a_label_without_probabilities_is_certain(tmp_path: Path) -> None:
    text = "run,t_start,t_end,label\na,0,1,sand\na,1,2,unknown\na,2,3,ice\na,3,4,\n"
    said = [window.answer for window in read_labels([written(tmp_path, text)])["a"]]
    assert [answer.unknown for answer in said] == [0.0, 1.0, 0.0]
    np.testing.assert_allclose(said[0].probability, [1.0, 0.0])
    np.testing.assert_allclose(said[2].probability, [0.0, 1.0])


def test_rows_without_numbers_say_nothing(tmp_path: Path) -> None:
    text = "run,t_start,t_end,label,p_ice,p_sand\na,0,1,ice,,\na,1,,ice,0.5,0.5\na,2,3,ice,0.5,0.5\n"
    assert [window.start for window in read_labels([written(tmp_path, text)])["a"]] == [2.0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("run,t_start,label\na,0,ice\n", "no column 't_end'"),
        ("run,t_start,t_end,label,p_ice\na,0,1,ice,0.3\n", "add up to 1"),
        ("run,t_start,t_end,label\na,0,1,\n", "no window has a label"),
    ],
)
def test_what_is_no_table_of_labels_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(LogError, match=said):
        read_labels([written(tmp_path, text)])


def test_a_table_is_told_from_a_name_by_its_ending() -> None:
    assert [is_label_file(text) for text in ("labels.csv", "a/B.CSV.gz", "sand", "csv")] == [
        True,
        True,
        False,
        False,
    ]
