# SPDX-License-Identifier: Apache-2.0
"""A client of Foxglove's protocol finds the topics and gets what the node says."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from live.sample_outputs import driven_status, next_moves, odometry_at, straight_path, waiting_status

from slipwise.errors import OutputError
from slipwise.live.outputs import Note, Output
from slipwise.live.watch.foxglove_server import FoxgloveServer

pytest.importorskip("foxglove")
pytest.importorskip("websockets")

from live.watch.foxglove_client import SUBPROTOCOLS, FoxgloveClient

SCHEMAS = {
    "/tf": "foxglove.FrameTransform",
    "/slipwise/driven": "foxglove.PosesInFrame",
    "/slipwise/predicted_path": "foxglove.PosesInFrame",
    "/slipwise/scene": "foxglove.SceneUpdate",
    "/slipwise/log": "foxglove.Log",
    "/slipwise/state": "slipwise.State",
    "/slipwise/parameters": "slipwise.Parameters",
    "/slipwise/slip": "slipwise.Slip",
    "/slipwise/nis": "slipwise.Nis",
    "/slipwise/next_moves": "slipwise.NextMoves",
}


@pytest.fixture
def server() -> Iterator[FoxgloveServer]:
    opened = FoxgloveServer(port=0)
    yield opened
    opened.close()


def _received(server: FoxgloveServer, topics: set[str], *outputs: Output) -> dict[str, tuple[int, bytes]]:
    """Return one message of each of the topics, by log time and payload."""
    with FoxgloveClient(server.url) as client:
        client.wait_for_channels(set(SCHEMAS))
        client.subscribe(topics)
        found: dict[str, tuple[int, bytes]] = {}
        deadline = time.monotonic() + 60.0
        while set(found) != topics:
            assert time.monotonic() < deadline
            for output in outputs:
                server.take(output)  # again until the subscription is in force
            try:
                topic, stamp, payload = client.message(timeout=0.2)
            except TimeoutError:
                continue
            found[topic] = (stamp, payload)
        return found


def test_topics_are_advertised_with_their_schemas(server: FoxgloveServer) -> None:
    with FoxgloveClient(server.url) as client:
        client.wait_for_channels(set(SCHEMAS))
        assert client.subprotocol in SUBPROTOCOLS
        assert client.info["name"] == "slipwise"
        assert {topic: channel["schemaName"] for topic, channel in client.channels.items()} == SCHEMAS
        encodings = {topic: channel["encoding"] for topic, channel in client.channels.items()}
        assert encodings["/slipwise/scene"] == "protobuf"
        assert json.loads(client.channels["/slipwise/nis"]["schema"])["title"] == "slipwise.Nis"
        assert "clientPublish" not in client.info["capabilities"]


def test_a_status_is_heard_as_numbers(server: FoxgloveServer) -> None:
    status = driven_status()
    topics = {f"/slipwise/{name}" for name in ("state", "parameters", "slip", "nis")}
    heard = _received(server, topics, status)
    said = {topic: json.loads(payload) for topic, (_, payload) in heard.items()}
    assert {stamp for stamp, _ in heard.values()} == {round(status.t * 1e9)}
    assert said["/slipwise/state"]["validity"] == status.validity
    assert said["/slipwise/state"]["left_out"] == status.counts
    values = [(p["name"], p["value"], p["high"]) for p in said["/slipwise/parameters"]["parameters"]]
    assert values == [(p.name, p.value, p.value + p.std) for p in status.parameters]
    assert status.slip is not None
    assert list(said["/slipwise/slip"].values()) == status.slip.tolist()
    assert said["/slipwise/nis"]["nis"] == status.nis


def test_moves_worth_driving_are_heard_by_who_comes_after_them(server: FoxgloveServer) -> None:
    server.take(next_moves())
    heard = _received(server, {"/slipwise/next_moves"}, driven_status())
    content = json.loads(heard["/slipwise/next_moves"][1])
    assert [move["v"] for move in content["moves"]] == [1.0, -0.5, 0.0]
    assert content["predictions"]["position"]["known"] == 1.0


def test_paths_transforms_and_notes_are_heard_with_well_known_schemas(server: FoxgloveServer) -> None:
    from slipwise.live.watch import foxglove_scene

    odometry, path, note, status = odometry_at(2.0), straight_path(), Note(3.0, "Ä"), driven_status()
    topics = {"/tf", "/slipwise/predicted_path", "/slipwise/log", "/slipwise/driven", "/slipwise/scene"}
    heard = _received(server, topics, odometry, path, note, status)
    moved = foxglove_scene.transform(odometry)
    assert moved is not None
    assert heard["/tf"] == (2_000_000_000, moved.encode())
    predicted = foxglove_scene.poses_in_frame(5.0, "map", path.poses)
    assert heard["/slipwise/predicted_path"] == (5_000_000_000, predicted.encode())
    said = foxglove_scene.log_line(3.0, "Ä", "slipwise")
    assert heard["/slipwise/log"] == (3_000_000_000, said.encode())
    driven = foxglove_scene.poses_in_frame(status.t, "map", status.driven)
    assert heard["/slipwise/driven"][1] == driven.encode()
    scene = heard["/slipwise/scene"][1]
    assert all(name in scene for name in (b"measured", b"fused", b"predicted"))


def test_hostile_numbers_and_texts_do_not_end_it(server: FoxgloveServer) -> None:
    bad = replace(odometry_at(math.nan), pose=np.full(3, np.inf))
    nowhere = waiting_status(
        t=-5.0, vehicle="\ud800", driven=np.full((2, 3), np.nan), slip=np.full(3, np.nan), nis=math.inf
    )
    heard = _received(server, {"/slipwise/state", "/slipwise/nis"}, bad, Note(1e300, "\udc80"), nowhere)
    assert json.loads(heard["/slipwise/nis"][1])["nis"] is None
    assert json.loads(heard["/slipwise/state"][1])["vehicle"] == "?"
    assert server.notices() == []


def test_a_port_that_is_taken_is_said(server: FoxgloveServer) -> None:
    with pytest.raises(OutputError, match="cannot serve Foxglove"):
        FoxgloveServer(port=server.port)
    with pytest.raises(OutputError, match="cannot serve Foxglove"):
        FoxgloveServer(port=99_999)


def test_beyond_this_machine_it_says_that_anybody_can_read() -> None:
    server = FoxgloveServer(host="0.0.0.0", port=0)
    try:
        (said,) = server.notices()
        assert "anybody" in said
        assert server.notices() == []
    finally:
        server.close()
        server.close()
