# SPDX-License-Identifier: Apache-2.0
"""A hundred hand-overs to a graph of real nodes narrow no limit, and apply nothing by halves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from live.wires.peer import DOMAIN, Peer
from sample_models import LIMITS, Made, make_model, named

from slipwise.calibration.live_table import ApplyTable
from slipwise.live.handover import Handover
from slipwise.live.parameter_call import NodeParameters
from slipwise.live.said import Said
from slipwise.live.wires.cyclone_wire import CycloneWire
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.wire import WireOptions

pytest.importorskip("cyclonedds")
pytestmark = pytest.mark.slow

TIMES = 100
DELAYS = {"FollowPath.model_delay_vx", "FollowPath.model_delay_wz"}
TOLD = DELAYS | {"FollowPath.VelocityDeadbandCritic.deadband_velocities"}
COMMAND = replace(named("edd-2", ang__w=-0.4), commands=True, limits=LIMITS)
WHEEL = named("edd-2", lon__V=-0.05, ang__w=-0.4)


@pytest.fixture
def graph(ros_python: Path, tmp_path: Path) -> Iterator[Peer]:
    with Peer(ros_python, "upstream_nodes.py", environment={"ROS_LOG_DIR": str(tmp_path)}) as peer:
        yield peer


@pytest.fixture
def wire() -> Iterator[CycloneWire]:
    opened = CycloneWire(WireOptions(node_name="handing_on", domain=DOMAIN))
    yield opened
    opened.close()


def hand_on(wire: CycloneWire, made: Made, folder: Path, **rules: Any) -> list[str]:
    """Hand models on, each a little slower to answer than the last; return what nodes and hand-over say."""
    said, nodes = Said(), NodeParameters(wire, ros_types())
    targets = ["diff-drive", "mppi", "amcl", "robot-localization"]
    rules |= {"mode": "auto", "set_parameters": True, "targets": targets, "folder": str(folder)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DISTRO", "lyrical")
        handover = Handover(ApplyTable(**rules), said)
    texts = []
    for k in range(TIMES):
        values = dict(made.values) | ({"log_delay_v": float(np.log(0.2 + 1e-4 * k))} if made.commands else {})
        for told in handover.hand_on(float(k), make_model(replace(made, values=values))):
            texts += [nodes.set(told)]
    return [text for text in [*texts, *(note.text for note in said.take_new())] if text]


def test_no_limit_is_narrowed_and_nothing_is_half_applied(
    graph: Peer, wire: CycloneWire, tmp_path: Path
) -> None:
    before = graph.ask("state")
    said = hand_on(wire, COMMAND, tmp_path / "a") + hand_on(wire, WHEEL, tmp_path / "b")
    after = graph.ask("state")
    for node in ("diff_drive_controller", "ekf_filter_node", "older_controller", "amcl"):
        assert str(after[node]) == str(before[node]), node
    mppi, earlier = after["controller_server"], before["controller_server"]
    assert {name for name, value in mppi["values"].items() if value != earlier["values"][name]} == TOLD
    assert len(mppi["calls"]) == TIMES
    assert all(set(call) == TOLD for call in mppi["calls"])
    assert mppi["values"]["FollowPath.model_delay_vx"] == pytest.approx(0.2 + 1e-4 * (TIMES - 1) + 0.3)
    assert sum("mppi: /controller_server took" in text for text in said) == 1
    assert sum("take effect when /diff_drive_controller is restarted" in text for text in said) == 1
    assert sum("no parameter callback" in text for text in said) == 2  # one for each of the two models


def test_a_node_that_cannot_take_one_is_given_none(graph: Peer, wire: CycloneWire, tmp_path: Path) -> None:
    before = graph.ask("state")
    said = hand_on(wire, COMMAND, tmp_path, nodes={"mppi": "/older_controller"})
    assert str(graph.ask("state")) == str(before)
    (text,) = [text for text in said if text.startswith("mppi: nothing of /older_controller was set")]
    assert "FollowPath.model_delay_wz cannot be changed while it runs" in text
    assert "nav2_mppi.yaml" in text
