# SPDX-License-Identifier: Apache-2.0
"""Of every log, a live node's last verdict is that of `calibrate`: good or not, and in the same words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from contradictory_logs import SKID_STEERED, sound_log, stopped, turned

import slipwise as sw
from slipwise.calibration import make_settings
from slipwise.calibration.coming import coming_of
from slipwise.calibration.prepared_run import prepare_run
from slipwise.errors import LogError, SlipwiseError
from slipwise.live.build import build_node
from slipwise.live.replay import Replay
from slipwise.logs import Log, LogOptions, open_log

QUICK = ("base_command_flipv",)


def difference(log: Log, input_name: str, basis: str = "auto") -> str:
    """Say what a live node says otherwise than `calibrate`; empty where nothing is."""
    replayed, said = Replay(log, input_name, rate=0.0), coming_of(log).settings()
    live = {name: value for name, value in said.items() if value is not None}
    settings = make_settings({"basis": basis, "live": live})
    built = build_node(replayed, input_name, settings)
    built.learning.learner.know_log(log)
    built.node.run()
    try:
        wanted = sw.calibrate(log, input=input_name, settings=settings).verdict
    except LogError as refused:
        return "" if built.learning.contradicted else f"calibrate says: {refused}"
    if built.learning.model is None:
        return "live has no model"
    verdict = built.learning.model.content.verdict
    told = (verdict.good, verdict.sentence, tuple(verdict.contradictions))
    asked = (wanted.good, wanted.sentence, wanted.contradictions)
    if built.learning.validity.whole == "estimated" and wanted.contradictions:
        return "live is valid"
    return "" if told == asked else f"live: {told}, calibrate: {asked}"


def differences(paths: list[Path], *, basis: str = "auto") -> dict[str, str]:
    """What live nodes say otherwise, of logs that can be learned from."""
    found = {}
    for path in paths:
        try:
            log = open_log(
                path, options=LogOptions(wheelbase=0.32 if path.parent.name == "f1tenth" else None)
            )
        except SlipwiseError:
            continue  # live refuses it at the same door
        for name in ("command", "wheel"):
            try:
                prepare_run(log, name)
            except LogError:
                continue
            said = difference(log, name, basis)
            if said:
                found[f"{path.name} from {name}s"] = said
    return found


LATE = stopped(
    sound_log(replace(SKID_STEERED, seconds=150.0)), 132.0, 0.002
)  # not good, as it was learned last


@pytest.mark.parametrize("log", [sound_log(), turned(sound_log(), 1.57), stopped(sound_log(), 30.0), LATE])
def test_a_live_verdict_is_that_of_calibrate(log: Log) -> None:
    assert difference(log, "wheel", "edd-2") == ""


def test_a_live_verdict_on_a_hostile_log_is_that_of_calibrate(real_log_dir: Path) -> None:
    hostile = real_log_dir.parent / "hostile" / "num"
    assert differences([hostile / f"{name}.csv" for name in QUICK], basis="edd-2") == {}


@pytest.mark.slow
def test_the_live_verdict_on_every_hostile_log_is_that_of_calibrate(real_log_dir: Path) -> None:
    hostile = real_log_dir.parent / "hostile"
    paths = [*sorted((hostile / "num").glob("*.csv")), *sorted(hostile.glob("*.csv"))]
    assert differences(paths, basis="edd-2") == {}  # real logs below are learned with `auto`


@pytest.mark.slow
def test_the_live_verdict_on_real_logs_is_that_of_calibrate(real_log_dir: Path) -> None:
    small = [path for path in sorted(real_log_dir.glob("*/*.csv.gz")) if path.stat().st_size < 150_000]
    assert differences(small) == {}
