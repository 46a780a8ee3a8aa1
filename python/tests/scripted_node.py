# SPDX-License-Identifier: Apache-2.0
"""A transport that delivers what a test says, and keeps what the node gives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.live_table import LiveTable
from slipwise.calibration.prepared_run import prepare_run
from slipwise.live.build import Built, build_node
from slipwise.live.feed import Feed
from slipwise.live.outputs import Note, Output, Status
from slipwise.live.replay import samples_of
from slipwise.live.samples import Sample

SLIP = Drive(
    seconds=90.0,
    seed=3,
    basis=_core.named_basis("edd-2"),
    alpha=(-0.1, -0.3),
    lag=0.2,
    delay=0.1,
    hold=(20, 60),
)


def driven(drive: Drive = SLIP, input_name: str = "wheel") -> list[Sample]:
    """The samples of a simulated drive, in the order of their stamps."""
    (run,) = prepare_run(simulated_log(drive), input_name)
    return list(samples_of(run))


class Scripted(Feed):
    """Delivers samples as fast as the node takes them, and keeps what the node gives."""

    def __init__(self, script: Iterable[Sample]) -> None:
        super().__init__(script)
        self.outputs: list[Output] = []

    def publish(self, output: Output) -> None:
        self.outputs.append(output)

    @property
    def said(self) -> list[str]:
        return [output.text for output in self.outputs if isinstance(output, Note)]

    @property
    def statuses(self) -> list[Status]:
        return [output for output in self.outputs if isinstance(output, Status)]


def run_node(
    script: Sequence[Sample],
    table: LiveTable | None = None,
    input_name: str = "wheel",
    basis: str = "edd-2",  # of the robot that most scripts drive; the loop does not depend on it
) -> tuple[Built, Scripted]:
    """Run a node over a script; return what it was built of, and the transport."""
    transport = Scripted(script)
    settings = Settings(basis=basis).model_copy(update={"live": table or LiveTable()})
    built = build_node(transport, input_name, settings, run="test")
    built.node.run()
    return built, transport
