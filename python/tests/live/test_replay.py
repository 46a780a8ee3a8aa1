# SPDX-License-Identifier: Apache-2.0
"""A log that is replayed gives the bytes of `calibrate`, whatever carries its samples."""

from __future__ import annotations

import io
import json
import socket
import threading
import time
from pathlib import Path

import pytest
from sample_logs import Drive, simulated_log
from scripted_node import SLIP

import slipwise as sw
from slipwise.calibration import Settings
from slipwise.calibration.prepared_run import prepare_run
from slipwise.errors import SettingsError
from slipwise.live.build import Built, build_node
from slipwise.live.pipe import Pipe
from slipwise.live.replay import Replay, samples_of
from slipwise.live.samples import Command, Pose, Wheels
from slipwise.live.udp import Udp
from slipwise.logs import Log


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Log:
    path = tmp_path_factory.mktemp("log") / "drive.csv"
    sw.save_log(simulated_log(SLIP), path)
    return sw.open_log(path)


def lines_of(log: Log, input_name: str) -> list[str]:
    """The samples of a log as lines of JSON."""
    rows: list[dict[str, float | str]] = []
    (run,) = prepare_run(log, input_name)
    for sample in samples_of(run):
        if isinstance(sample, Command):
            rows.append({"t": sample.t, "cmd_v": sample.v, "cmd_omega": sample.omega})
        elif isinstance(sample, Wheels):
            rows.append({"t": sample.t, "odo_v": sample.v, "odo_omega": sample.omega})
        elif isinstance(sample, Pose):
            rows.append({"t": sample.t, "x": sample.x, "y": sample.y, "yaw": sample.yaw})
    return [json.dumps(row) for row in rows]


def without_origin(text: str) -> str:
    """A model file without the log that it came from."""
    return "\n".join(line for line in text.splitlines() if "sha256" not in line and "logs:" not in line)


def test_runs_of_a_log_stay_apart() -> None:
    runs = tuple(simulated_log(Drive(seconds=30.0, seed=seed, name=f"run-{seed}")).runs[0] for seed in (1, 2))
    log = Log(runs=runs)
    built = build_node(Replay(log, "wheel", rate=0.0), "wheel", Settings())
    built.node.run()
    model, _ = built.learning.learner.judged_model(log=log)
    assert model.content == sw.calibrate(log, input="wheel").model.content


def through_pipe(log: Log, input_name: str) -> Built:
    results = io.BytesIO()
    lines = io.BytesIO("\n".join(lines_of(log, input_name)).encode())
    built = build_node(Pipe(lines, results), input_name, Settings(), run="a pipe")
    built.node.run()
    said = [json.loads(line) for line in results.getvalue().splitlines()]
    assert any("odometry" in each for each in said)
    return built


def through_udp(log: Log, input_name: str) -> Built:
    transport = Udp("127.0.0.1:0")
    built = build_node(transport, input_name, Settings(), run="UDP")

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for k, line in enumerate(lines_of(log, input_name)):
                while transport.packets < k - 20:
                    time.sleep(0.001)
                sender.sendto(line.encode(), ("127.0.0.1", transport.port))
        while transport.packets <= k or built.node.waiting:
            time.sleep(0.001)
        built.node.stop()

    thread = threading.Thread(target=send)
    thread.start()
    built.node.run()
    thread.join()
    assert not built.said.counts
    return built


@pytest.mark.slow
@pytest.mark.parametrize("carried", [through_pipe, through_udp])
def test_what_other_transports_carry_gives_the_same_model(log: Log, carried: object) -> None:
    assert callable(carried)
    built = carried(log, "wheel")
    model = built.learning.learner.model()
    wanted = sw.calibrate(log, input="wheel").model
    assert without_origin(model.to_yaml()) == without_origin(wanted.to_yaml())


def test_a_rate_below_zero_is_refused(log: Log) -> None:
    with pytest.raises(SettingsError, match="--rate"):
        Replay(log, "wheel", rate=-1.0)


def test_the_rate_is_times_real_time() -> None:
    log = simulated_log(Drive(seconds=4.0))
    began = time.monotonic()
    build_node(Replay(log, "wheel", rate=10.0), "wheel", Settings()).node.run()
    assert time.monotonic() - began > 0.35


def test_a_wrong_line_is_said_once_and_the_rest_goes_on(tmp_path: Path) -> None:
    lines = ["t,odo_v,odo_omega", "1.0,0.5", "2.0,0.5", "3.0,0.5,0.1", "x,0.5,0.1"]
    built = build_node(Pipe(io.BytesIO("\n".join(lines).encode())), "wheel", Settings(), run="a pipe")
    built.node.run()
    said = [text for _, text in built.said.log()]
    assert [text for text in said if "left out" in text] == [
        "left out, line 2: 2 cells where the header has 3",
        "left out, line 5: t is 'x', not a number",
    ]
