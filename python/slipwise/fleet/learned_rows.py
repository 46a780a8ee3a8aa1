# SPDX-License-Identifier: Apache-2.0
"""What a worker does with one log: opens it, learns it, and returns one row per parameter."""

from __future__ import annotations

import hashlib
import json
import math
import time
import warnings
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from slipwise.addresses import remote_url, shown
from slipwise.calibration import Settings, load_settings
from slipwise.calibration.from_prior import calibrate_from
from slipwise.errors import LogError, OlderNames, SlipwiseError
from slipwise.files import sha256_of
from slipwise.fleet.find_logs import LogTask
from slipwise.fleet.knowledge_file import knowledge_text
from slipwise.fleet.vehicle_numbers import VehicleNumbers, vehicle_numbers
from slipwise.logs import Log, open_log
from slipwise.logs.options import vehicle_file
from slipwise.logs.remote import lent, remote_version
from slipwise.logs.vehicle_description import load_vehicle
from slipwise.models.body_force import without_force
from slipwise.models.car import curve_gains
from slipwise.models.model import Model
from slipwise.models.parameter_table import known
from slipwise.models.step_response import rise_times

FIRST_UNIX_TIME = 946684800.0  # s, the year 2000; a log with earlier stamps counts from its own start


@dataclass(frozen=True)
class Row:
    """One parameter of one log, in the unit of the model file."""

    parameter: str
    unit: str
    value: float
    std: float
    prior_std: float  # NaN of what follows from several parameters
    identifiable: bool


@dataclass(frozen=True)
class LogRows:
    """What was learned of one log, or why nothing was."""

    key: str  # of the log's bytes and the settings; empty where the log could not be fetched
    log: str
    vehicle: str
    month: str  # such as 2026-11
    log_sha256: str
    settings_sha256: str
    version: str
    start: float  # s since 1970
    seconds: float  # of driving learned from
    distance: float  # m between measured poses
    input: str = ""
    good: bool = False
    verdict: str = ""
    rows: tuple[Row, ...] = ()
    numbers: VehicleNumbers = VehicleNumbers()
    failure: str = ""  # why there are no rows
    known: bool = False  # a log on a server is that which was learned before
    tag: str = ""  # of the version on the server
    knowledge: str = ""  # JSON of what the log says in the terms of every basis


def learn_task(task: LogTask) -> LogRows:
    """Learn one log; a log that cannot be used is no error, its reason is in what is returned.

    One on a server is fetched into a temporary file, which is removed before the next is.
    """
    settings = _settings_of(task)
    url = remote_url(task.path)
    if url is None:
        return _learned(task, settings, Path(task.path).stat().st_mtime)
    try:
        on_server = remote_version(url)
        if task.tag and on_server.tag == task.tag:
            return replace(_head(task, settings, 0.0), known=True, tag=task.tag)
        changed = time.time() if on_server.changed is None else on_server.changed
        with lent(url) as copy:
            there = replace(task, log_sha256=log_hash(copy))
            if there.log_sha256 == task.log_sha256:
                return replace(_head(there, settings, changed), known=True, tag=on_server.tag)
            return replace(_learned(there, settings, changed), tag=on_server.tag)
    except LogError as problem:
        return replace(_head(task, settings, 0.0), key="", failure=str(problem))


def _settings_of(task: LogTask) -> Settings:
    """Return the settings of a task; what is to be said of their file is said once, not for each log."""
    if not task.settings:
        return Settings()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OlderNames)
        return load_settings(Path(task.settings))


def _learned(task: LogTask, settings: Settings, changed: float) -> LogRows:
    head = _head(task, settings, changed)
    try:
        log = open_log(Path(task.path), options=settings.log_options())
        calibration, known = calibrate_from(log, None, settings=settings)
    except SlipwiseError as problem:
        return replace(head, failure=str(problem))
    content = calibration.model.content
    if content.verdict.contradictions:  # its numbers are of no robot
        return replace(head, failure=calibration.verdict.sentence)
    start = _start(log, changed)
    return replace(
        head,
        month=f"{datetime.fromtimestamp(start, UTC):%Y-%m}",
        start=start,
        seconds=content.provenance.learned_seconds,
        distance=_distance(log),
        input=content.input,
        good=calibration.verdict.good,
        verdict=calibration.verdict.sentence,
        rows=_rows(calibration.model),
        numbers=vehicle_numbers(calibration.model),
        knowledge="" if known is None else knowledge_text(known),
    )


def log_hash(path: Path) -> str:
    """Return the SHA-256 of a log's bytes, of all files of a folder with their names.

    Raises:
        OSError: it cannot be read.
    """
    if not path.is_dir():
        return sha256_of(path)
    digest = hashlib.sha256()
    for inside in sorted(path.rglob("*")):
        if inside.is_file():
            digest.update(f"{inside.relative_to(path)} {sha256_of(inside)}\n".encode())
    return digest.hexdigest()


def settings_hash(settings: Settings) -> str:
    """Return the SHA-256 of settings, however they were written, and of the vehicle's file that they name."""
    said = settings.model_dump(mode="json")
    vehicle = said["log"]["vehicle"]
    if vehicle_file(vehicle) is not None:
        said["vehicle_file"] = load_vehicle(vehicle).model_dump(mode="json")
    text = json.dumps(said, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def key_of(log_sha256: str, settings_sha256: str) -> str:
    """Return what a log learned with some settings is kept under."""
    return f"{log_sha256[:16]}-{settings_sha256[:16]}"


def _head(task: LogTask, settings: Settings, changed: float) -> LogRows:
    settings_sha256 = settings_hash(settings)
    return LogRows(
        key=key_of(task.log_sha256, settings_sha256),
        log=shown(task.path),
        vehicle=task.vehicle,
        month=f"{datetime.fromtimestamp(changed, UTC):%Y-%m}",
        log_sha256=task.log_sha256,
        settings_sha256=settings_sha256,
        version=version("slipwise"),
        start=changed,
        seconds=0.0,
        distance=0.0,
    )


def _start(log: Log, changed: float) -> float:
    """Return when the log begins [s since 1970]: by its stamps, or by the file where these are not such."""
    first = min(run.span[0] for run in log.runs)
    return first if first >= FIRST_UNIX_TIME else changed


def _distance(log: Log) -> float:
    """Return the way between measured poses [m], not across a change of frame."""
    total = 0.0
    for run in log.runs:
        poses = run.poses
        same = np.diff(poses.frame) == 0
        total += float(np.hypot(np.diff(poses.x), np.diff(poses.y))[same].sum())
    return total


def _rows(model: Model) -> tuple[Row, ...]:
    """All parameters, and how late the robot is in all, which compares where structures differ.

    A curve is one number here: fifty values of it would hide what is odd among tests of chance.
    """
    model = without_force(model)  # a force is of its day
    table = model.table
    single = [row for row in table.rows if row.at is None and row.std > 0.0]
    return (
        *(
            Row(p.name, p.unit, p.value, p.std, p.prior_std, p.identifiable)
            for p in (*single, *curve_gains(table, model.content.range))
        ),
        *(Row(name, "s", *risen, math.nan, known(*risen)) for name, risen in rise_times(model).items()),
    )
