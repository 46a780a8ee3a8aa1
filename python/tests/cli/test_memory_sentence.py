# SPDX-License-Identifier: Apache-2.0
"""What `slipwise evaluate --memory` makes of errors over those of a learner without a memory."""

from __future__ import annotations

import pytest

from slipwise.cli.evaluate_memory import of_the_memory


@pytest.mark.parametrize(
    ("position", "heading", "said"),
    [
        (0.997, 0.999, "no difference"),
        (0.98, 1.004, "the memory pays"),
        (0.996, 1.03, "leave --memory out"),
        (0.9, 1.1, "better at the one"),
    ],
)
def test_a_memory_pays_where_it_makes_a_difference(position: float, heading: float, said: str) -> None:
    assert f"without: {said}" in of_the_memory(position, heading)
