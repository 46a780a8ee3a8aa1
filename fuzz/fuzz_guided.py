# SPDX-License-Identifier: Apache-2.0
"""Fuzzes one reader, guided by the code that is reached (atheris): TARGET SECONDS EXECUTIONS SEED FOLDER."""

from __future__ import annotations

import importlib
import random
import sys
import tempfile
from pathlib import Path

import atheris

READERS = (  # loaded when they are needed otherwise, too late to be instrumented
    *(
        "slipwise.logs.bag",
        "slipwise.logs.flight_log",
        "slipwise.logs.foxglove_file",
        "slipwise.logs.pose_file",
        "slipwise.logs.tidy",
        "slipwise.models",
        "slipwise.planning",
        "slipwise.calibration",
    ),
    *("rosbags.rosbag1.reader", "rosbags.rosbag2.reader", "rosbags.typesys"),
)

with atheris.instrument_imports(include=["slipwise", "rosbags", "yaml"]):
    from mutations import mutated
    from seeds import seeds
    from targets import Target

    for reader in READERS:
        importlib.import_module(reader)

MEMORY = 2048  # MiB


def main() -> None:
    """Hand the reader to libFuzzer, which ends the process: with 0, or with a finding in the folder."""
    name, seconds, executions, seed, folder = sys.argv[1:6]
    target, corpus = Target(name), seeds(name)

    def change(data: bytes, most: int, number: int) -> bytes:
        draw = random.Random(number)
        if draw.random() < 0.5:
            return bytes(atheris.Mutate(data, most))
        return mutated(data, draw, corpus)[:most]

    with tempfile.TemporaryDirectory() as start:
        for number, data in enumerate(corpus):
            (Path(start) / str(number)).write_bytes(data)
        options = (
            *(f"-max_total_time={max(1, round(float(seconds)))}", f"-runs={executions}", f"-seed={seed}"),
            *("-timeout=60", f"-rss_limit_mb={MEMORY}", "-max_len=1000000", "-verbosity=0"),
            *("-print_final_stats=1", f"-artifact_prefix={folder}/{name}-"),
        )
        atheris.Setup([sys.argv[0], *options, start], target.run_unread, custom_mutator=change)
        print(f"fuzz: {name}: guided by the code that is reached", flush=True)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
