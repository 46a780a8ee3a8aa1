# SPDX-License-Identifier: Apache-2.0
"""The method judged is the one that a model file could hold."""

from __future__ import annotations

import pytest

from slipwise.cli.evaluation_verdict import judged_method


@pytest.mark.parametrize(
    ("methods", "judged"),
    [
        (("none", "edd-2", "auto"), "auto"),
        (("none", "auto", "model"), "model"),
        (("none", "vendor", "batch", "icr-3", "ipem-9"), "icr-3"),
        (("none", "slip-ratio-ekf", "slip-ratio-smo", "edd-2"), "edd-2"),
        (("none", "slip-ratio-ekf", "slip-ratio-smo"), None),
        (("none", "vendor", "batch"), None),
    ],
)
def test_first_method_that_learns_a_model_is_judged_after_model_and_auto(
    methods: tuple[str, ...], judged: str | None
) -> None:
    assert judged_method(methods) == judged
