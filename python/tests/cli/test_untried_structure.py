# SPDX-License-Identifier: Apache-2.0
"""A memory whose surfaces were learned by a structure that the settings do not try."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from cli.conftest import Result
from sample_surfaces import FIRM, floor_log

from slipwise.logs import save_log
from slipwise.models import load_model

Slipwise = Callable[..., Result]


def test_the_error_names_the_file_and_what_to_do(slipwise: Slipwise, folder: Path) -> None:
    first, second, model = folder / "a.csv", folder / "b.csv", folder / "mem.yaml"
    save_log(floor_log(FIRM, 1), first)
    save_log(floor_log(FIRM, 2), second)
    learn = ("calibrate", "--memory", "--no-report")
    assert slipwise(*learn, first, "-o", model).code == 0
    assert load_model(model).content.delays
    said = (
        "the surfaces were learned by the structure 'direct', which is not tried with the basis edd-2 "
        f"({model}): leave --basis away, or give the settings that they were learned with (basis 'auto')"
    )
    refused = slipwise(*learn, model, second, "--basis", "edd-2")
    assert refused.code == 2
    assert refused.line == said
    live = ("live", "--replay", second, "--rate", "0", "--memory", "--model", model, "--set", "basis=edd-2")
    assert slipwise(*live).line == said
    assert slipwise(*learn, model, second).code == 0
