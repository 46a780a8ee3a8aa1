# SPDX-License-Identifier: Apache-2.0
"""What a file holds, topic by topic or column by column, and which of it is used as what, and why."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.addresses import shown
from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.messages import TF
from slipwise.logs.options import LogOptions

if TYPE_CHECKING:
    from slipwise.logs.role_choice import Topic
    from slipwise.logs.topics import TopicRoles

DAMAGED = "damaged-bag"
_CALLED = {"pose": "the pose", "command": "the command", "wheel": "the wheels", "imu": "the IMU"}


@dataclass(frozen=True)
class Part:
    """A topic of a bag, or a column of a table."""

    name: str
    type: str  # of the messages, or "column"
    count: int  # messages, or cells that are filled
    rate: float  # [Hz] messages over the duration of the bag; NaN where that is not known
    used_as: str  # "pose", "command", "wheel", "imu", several of them with commas, or nothing
    why: str


@dataclass(frozen=True)
class Survey:
    """What one file holds."""

    path: str
    format: str
    parts: tuple[Part, ...]


def survey_log(path: str | Path, options: LogOptions) -> Survey:
    """Look at what a file holds without judging it: nothing that is merely unclear is an error.

    Raises:
        LogError: the file is missing, damaged or of an unknown kind.
    """
    from slipwise.logs.flight_log import flight_format
    from slipwise.logs.open_log import named_in_errors, readable

    path = Path(path)
    file, bag = readable(path)
    with named_in_errors(path, file):
        if not bag and (kind := flight_format(file)) is not None:
            return _survey_flight(path, file, kind, options)
        return (_survey_bag if bag else _survey_table)(path, file, options)


def _survey_bag(path: Path, file: Path, options: LogOptions) -> Survey:
    from slipwise.logs.bag import collect_transforms, transform_source
    from slipwise.logs.bag_file import bag_files
    from slipwise.logs.foxglove_file import open_bag
    from slipwise.logs.topics import weigh_topics

    tally = Tally()
    with open_bag(file, bag_files(file), tally) as bag:
        topics = sorted(bag.topics, key=lambda topic: topic.name)
        if not any(topic.count for topic in topics) and any(e.kind == DAMAGED for e in tally.result()):
            raise LogError(
                "the bag is cut off: no message is left", where=shown(path), advice="copy it again"
            )
        source = transform_source(bag, collect_transforms(bag, options), options)
        found = weigh_topics(topics, options, source)
        parts = tuple(_part(topic, found) for topic in topics)
        return Survey(shown(path), bag.format, parts)


def _part(topic: Topic, found: TopicRoles) -> Part:
    uses = {role: choice.why for role, choice in found.named() if choice.topic == topic}
    against = [
        f"not {_CALLED[role]}: {choice.rejected[topic.name]}"
        for role, choice in found.named()
        if topic.name in choice.rejected
    ]
    if uses:
        why = "; ".join(dict.fromkeys(uses.values()))
    elif topic.count == 0:
        why = "it has no messages"
    elif topic.type == TF and topic.name.endswith("static"):
        why = "read where the pose comes from TF"
    else:
        why = "; ".join(against) or "its type is not a pose, command or wheel speed"
    return Part(topic.name, topic.type, topic.count, topic.rate, ", ".join(uses), why)


def _survey_flight(path: Path, file: Path, kind: str, options: LogOptions) -> Survey:
    from slipwise.logs.flight_log import flight_streams, read_flight_messages

    messages = read_flight_messages(file, kind)
    chosen = flight_streams(messages, options)
    roles = {"command": chosen.commands, "wheel": chosen.wheels, "pose": chosen.poses}
    parts = []
    for name, columns in messages.topics.items():
        used = [role for role, stream in roles.items() if stream and name in stream.topic.split(", ")]
        t = columns["t"]
        span = float(t[-1] - t[0])
        rate = (len(t) - 1) / span if span > 0.0 else float("nan")
        why = "; ".join(note for note in chosen.notes if name in note) or "not needed beside the others"
        parts.append(Part(name, "message", len(t), rate, ", ".join(used), why))
    return Survey(shown(path), kind, tuple(parts))


def _survey_table(path: Path, file: Path, options: LogOptions) -> Survey:
    from slipwise.logs.tidy import load_table
    from slipwise.logs.tidy_columns import use_of_column

    table = load_table(file, options, Tally())
    parts = []
    for name in table.names:
        column = table.arrow.column(name)
        used_as, why = use_of_column(name, table.names, options)
        own = options.columns.get(name, name)
        why = why if own == name else f"{name} by --columns" + (f"; {why}" if why else "")
        parts.append(Part(own, "column", len(column) - column.null_count, float("nan"), used_as, why))
    return Survey(shown(path), table.format, tuple(parts))
