# SPDX-License-Identifier: Apache-2.0
"""What a log says is read back equal, and what is no such text is refused."""

from __future__ import annotations

import numpy as np
import pytest
from fleet.work_samples import sample_rows

from slipwise.calibration.log_knowledge import BasisKnowledge, LearnedNormal, LogKnowledge, StructureKnowledge
from slipwise.fleet import Store
from slipwise.fleet.knowledge_file import knowledge_from, knowledge_text

NORMAL = LearnedNormal(np.array([1.0, 2.0]), np.array([[1.0, 0.1], [0.1, 2.0]]), np.zeros(2), np.ones(2))
NONE = LearnedNormal(np.empty(0), np.empty((0, 0)), np.empty(0), np.empty(0))
KNOWN = LogKnowledge(
    "command",
    "joint",
    {
        "joint": StructureKnowledge(
            (1.5, 0.7),
            {"edd-2": BasisKnowledge(NORMAL, 0.6, np.ones(3)), "none": BasisKnowledge(NONE, 0.4, np.ones(3))},
            ("a", "b"),
            NORMAL,
        ),
        "cascaded": StructureKnowledge((1.5, 0.7), {}, (), None),
    },
)


def test_it_is_read_back_equal() -> None:
    text = knowledge_text(KNOWN)
    back = knowledge_from(text)
    assert knowledge_text(back) == text
    np.testing.assert_array_equal(back.structures["joint"].bases["edd-2"].slip.covariance, NORMAL.covariance)
    assert back.structures["joint"].bases["none"].slip.covariance.shape == (0, 0)
    assert back.structures["cascaded"].robot is None


def test_what_is_no_such_text_is_refused(subtests: pytest.Subtests) -> None:
    for text in ["", "{", "[]", "{}", '{"input": 1, "kept": 2, "structures": 3}']:
        with subtests.test(text=text), pytest.raises(ValueError, match=r"."):
            knowledge_from(text)


def test_a_store_keeps_it_by_vehicle_and_passes_damaged_files(tmp_path) -> None:  # type: ignore[no-untyped-def]
    store = Store(tmp_path)
    store.add(sample_rows(vehicle="a/b", knowledge=knowledge_text(KNOWN)))
    (vehicle, known), *more = store.knowledge()
    assert (vehicle, known.kept, more) == ("a/b", "joint", [])
    (path,) = (tmp_path / "knowledge").rglob("*.json")
    path.write_text("{")
    assert store.knowledge() == []
