# SPDX-License-Identifier: Apache-2.0
"""A line is a row of a tidy log: every kind of log teaches the same replayed, and pushed line by line."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

from sample_kinds import Kind, kinds

from slipwise.calibration import Settings, make_settings
from slipwise.calibration.coming import Coming, coming_of
from slipwise.calibration.settings import merged
from slipwise.errors import SlipwiseError
from slipwise.live.build import Built, build_node
from slipwise.live.coming import ComingLines
from slipwise.live.pipe import Pipe
from slipwise.live.replay import Replay
from slipwise.live.transport import Transport
from slipwise.logs import LogOptions, open_log


def settings_for(coming: Coming, options: LogOptions) -> Settings:
    said = {name: value for name, value in coming.settings().items() if value is not None}
    read = {} if options.car is None else {"log": {"vehicle": options.vehicle}}
    return make_settings(merged({"live": said, "basis": "drive-9"}, read))


def learned(transport: Transport, coming: Coming, kind: Kind, options: LogOptions) -> Built:
    built = build_node(transport, kind.input, settings_for(coming, options), run="lines")
    built.node.run()
    return built


def taught(built: Built) -> str:
    """What was learned, without where it came from and which contradictions a whole log shows."""
    core = built.learning.learner.model(limits=False).content
    return core.model_copy(
        update={"provenance": core.provenance.model_copy(update={"logs": []})}
    ).model_dump_json()


def difference(kind: Kind, folder: Path) -> str:
    """Say what lines teach otherwise than their table; empty where nothing is."""
    path, options = kind.read(folder)
    pipe = Pipe(io.BytesIO(kind.text().encode()), options=options)
    try:
        log, coming = open_log(path, options=options), pipe.look()
        if replace(coming, input_name="wheel") != ComingLines(**vars(coming_of(log))):
            return f"lines show {coming}, their table {coming_of(log)}"
        wanted = taught(learned(Replay(log, kind.input, rate=0.0), coming, kind, options))
        built = learned(pipe, coming, kind, options)
        found, counted = taught(built), sorted(built.said.counts)
    except SlipwiseError as problem:
        return str(problem)
    at = next((i for i, pair in enumerate(zip(wanted, found, strict=False)) if pair[0] != pair[1]), None)
    return (
        "" if at is None else f"{wanted[at - 60 : at + 20]} / {found[at - 60 : at + 20]}, counted {counted}"
    )


def test_lines_teach_what_their_table_does(tmp_path: Path) -> None:
    found = {}
    for name, kind in kinds().items():
        (tmp_path / name).mkdir()
        found[name] = difference(kind, tmp_path / name)
    assert {name: said for name, said in found.items() if said} == {}
