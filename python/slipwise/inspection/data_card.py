# SPDX-License-Identifier: Apache-2.0
"""The data card of a shared log: what people must know before they use it, written beside the table."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from slipwise.errors import LogError
from slipwise.files import write_text_whole
from slipwise.inspection.inspect_log import Inspection
from slipwise.logs import Log
from slipwise.models.yaml_file import read_yaml
from slipwise.validation_text import first_problem

CARD_VERSION = 1
NOT_STATED = "not stated"
FRAMES = (
    "x forward, y left, z up, yaw counter-clockwise (REP-103); SI units; poses are those of the "
    "pose sensor's child frame in a frame that is fixed to the ground, comparable inside one frame of one "
    "run only"
)
ANONYMISED = (
    "each frame of each run is turned and moved so that its first pose is the origin with a yaw of 0 and a "
    "height of 0; stamps count from the start of the log, gaps between runs are cut to an hour; names of "
    "runs are hashes; roll and pitch, speeds and intervals are as measured"
)
Text = Annotated[str, Field(min_length=1, max_length=2000)]
Count = Annotated[int, Field(ge=0)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class CardStream(_Section):
    """One stream of the log."""

    name: Text
    samples: Count
    seconds: float  # s
    rate: float | None  # Hz, the usual one; None where there are too few samples
    longest_gap: float | None  # s


class CardNumber(_Section):
    """One parameter that the log determines, as slipwise learned it."""

    name: Text
    unit: str
    value: float
    std: float


class CardFile(_Section):
    """The table that the card is of."""

    name: Text
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    rows: Count


class DataCard(_Section):
    """Everything on the card."""

    card: Literal[1]
    file: CardFile
    licence: Text  # an SPDX identifier, such as CC-BY-4.0
    vehicle: Text
    sensors: Text
    frames: Text
    anonymised: str  # what was done; empty where nothing was
    runs: Count
    distance: float  # m, along the measured poses
    streams: list[CardStream]
    identified: dict[Literal["command", "wheel"], list[CardNumber]]
    learned_from: dict[Literal["command", "wheel"], Text]  # how much was driven, or what was missing
    slipwise_version: Text


@dataclass(frozen=True)
class Stated:
    """What the log itself cannot say."""

    licence: str = NOT_STATED
    vehicle: str = NOT_STATED
    sensors: str = NOT_STATED


def card_path(table: Path) -> Path:
    """Where the card of a table is."""
    return table.with_name(f"{table.stem}.card.yaml")


def make_card(table: Path, inspection: Inspection, stated: Stated, *, anonymised: bool) -> DataCard:
    """Return the card of a table that was read back and inspected."""
    log = inspection.log
    source = log.sources[0]
    return DataCard(
        card=CARD_VERSION,
        file=CardFile(name=table.name, sha256=source.sha256, rows=source.rows),
        licence=stated.licence,
        vehicle=stated.vehicle,
        sensors=stated.sensors,
        frames=FRAMES,
        anonymised=ANONYMISED if anonymised else "",
        runs=len(log.runs),
        distance=_distance(log),
        streams=[
            CardStream(
                name=stream.name,
                samples=stream.samples,
                seconds=stream.seconds,
                rate=_finite(stream.rate),
                longest_gap=_finite(stream.longest_gap),
            )
            for stream in inspection.streams
        ],
        identified={
            item.input: [
                CardNumber(name=p.name, unit=p.unit, value=p.value, std=p.std)
                for p in item.parameters
                if p.identifiable
            ]
            for item in inspection.learned
        },
        learned_from={
            item.input: item.missing or f"{item.windows} segments, {item.seconds:.0f} s of driving"
            for item in inspection.learned
        },
        slipwise_version=version("slipwise"),
    )


def write_card(card: DataCard, path: Path) -> None:
    """Write the card as YAML.

    Raises:
        OutputError: it cannot be written.
    """
    content: dict[str, Any] = card.model_dump()
    write_text_whole(path, yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=100))


def read_card(path: Path) -> DataCard:
    """Return the card in a file.

    Raises:
        LogError: it is missing, not plain YAML, or not such a card.
    """
    try:
        return DataCard.model_validate(read_yaml(path, error=LogError))
    except ValidationError as problem:
        raise LogError(
            f"not a data card: {first_problem(problem)}", where=str(path), advice="write it again"
        ) from None


def _distance(log: Log) -> float:
    """How far the poses went, jumps between frames left out [m]."""
    metres = 0.0
    for run in log.runs:
        same = np.diff(run.poses.frame) == 0
        metres += float(np.hypot(np.diff(run.poses.x), np.diff(run.poses.y))[same].sum())
    return metres


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
