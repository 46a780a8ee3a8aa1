# SPDX-License-Identifier: Apache-2.0
"""Rows of a fleet on disk: Parquet by vehicle and month, a file per log, each written whole."""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from sys import intern
from typing import Any
from urllib.parse import quote, unquote

import numpy as np
from numpy.typing import NDArray

from slipwise.addresses import shown
from slipwise.calibration.log_knowledge import LogKnowledge
from slipwise.files import output_errors, write_text_whole, write_whole
from slipwise.fleet.knowledge_file import knowledge_from
from slipwise.fleet.learned_rows import LogRows, Row
from slipwise.fleet.log_kinds import by_kind
from slipwise.fleet.vehicle_numbers import NAMES

ROWS, UNUSABLE, KNOWLEDGE, ADDRESSES = "rows", "unusable", "knowledge", "addresses"
SET_ASIDE = "set-aside"  # what could not be read
LONGEST_NAME = 150  # bytes of a vehicle's name in that of a folder, of which most systems allow 255
#: Of the rows that a fleet is looked at by.
COLUMNS = (
    "vehicle",
    "month",
    "key",
    "start",
    "seconds",
    "distance",
    "input",
    "good",
    "parameter",
    "unit",
    "value",
    "std",
    *NAMES,
)
_TEXTS = ("vehicle", "month", "key", "input", "parameter", "unit")
PARTS = "vehicle=*/month=*/*.parquet"  # not those in the making, which lie in hidden folders
AT_ONCE = 500  # files
MOST_KNOWN = 4000  # logs that the prior is made of, so that the driver's memory stays bounded
_KEY = re.compile(r"[0-9a-f]{16}-[0-9a-f]{16}")
_OF_LOG = ("key", "log", "log_sha256", "settings_sha256", "version", "start", "seconds", "distance")
_OF_VERDICT = ("input", "good", "verdict")

__all__ = ["Row", "Store"]


class Store:
    """A folder of results: `rows/vehicle=X/month=Y/KEY.parquet`, `knowledge`, and `unusable/KEY.json`.

    A log that was learned with several settings counts once: with those of `settings_sha256`, or as it was
    learned last.
    """

    def __init__(self, folder: Path, settings_sha256: str = "") -> None:
        self.folder = folder
        self._settings = settings_sha256[:16]

    def keys(self) -> frozenset[str]:
        """Return the keys of all logs that need not be learned again, the unusable ones too."""
        return frozenset(path.stem for path in self._results())

    def _results(self) -> list[Path]:
        found = [*(self.folder / ROWS).glob(PARTS), *(self.folder / UNUSABLE).glob("*.json")]
        return [path for path in found if _KEY.fullmatch(path.stem)]

    def _counting(self) -> set[str]:
        """Return the keys that count, one of each log."""
        of_log: dict[str, Path] = {}
        for path in self._results():
            log = path.stem.partition("-")[0]
            of_log[log] = max(of_log[log], path, key=self._order) if log in of_log else path
        return {path.stem for path in of_log.values()}

    def _order(self, path: Path) -> tuple[bool, int]:
        return path.stem.endswith(f"-{self._settings}"), path.stat().st_mtime_ns

    def add(self, learned: LogRows) -> Path:
        """Write what was learned of one log, or why nothing was; return the file.

        Raises:
            OutputError: it cannot be written.
        """
        if not learned.rows:
            path = self.folder / UNUSABLE / f"{learned.key}.json"
            path.parent.mkdir(parents=True, exist_ok=True)
            content = {name: getattr(learned, name) for name in (*_OF_LOG, "vehicle", "month", "failure")}
            write_text_whole(path, json.dumps(content, indent=1) + "\n")
            return path
        vehicle, month = folder_name(learned.vehicle), quote(learned.month, safe="")
        if learned.knowledge:
            known = self.folder / KNOWLEDGE / f"vehicle={vehicle}" / f"{learned.key}.json"
            known.parent.mkdir(parents=True, exist_ok=True)
            write_text_whole(known, learned.knowledge)
        path = self.folder / ROWS / f"vehicle={vehicle}" / f"month={month}" / f"{learned.key}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, lambda temporary: _write(temporary, learned))
        return path

    def address(self, url: str) -> tuple[str, str]:
        """Return hash and version's tag of what was learned from an address; both empty where nothing was.

        The tag is empty where the address had another key to the file, which may choose another file.
        """
        try:
            entry = json.loads(self._address_file(url).read_text(encoding="utf-8"))
            digest, tag = str(entry["log_sha256"]), str(entry["tag"])
            return digest, tag if entry["url_sha256"] == _text_hash(url) else ""
        except (OSError, ValueError, KeyError, TypeError):
            return "", ""

    def add_address(self, url: str, digest: str, tag: str) -> None:
        """Remember what was learned from an address, without what it keeps secret.

        Raises:
            OutputError: it cannot be written.
        """
        path = self._address_file(url)
        path.parent.mkdir(parents=True, exist_ok=True)
        entry = {"address": shown(url), "url_sha256": _text_hash(url), "tag": tag, "log_sha256": digest}
        write_text_whole(path, json.dumps(entry) + "\n")

    def _address_file(self, url: str) -> Path:
        return self.folder / ADDRESSES / f"{_text_hash(shown(url))[:32]}.json"

    def table(self) -> dict[str, NDArray[Any]]:
        """Return the columns `COLUMNS` of all rows by name, in order of vehicle and time; empty without rows.

        Parameters of logs with other inputs than most have names of their own (`log_kinds.py`).
        Some files are read at once, and a text is there once: thousands of logs take little memory.
        """
        counting = self._counting()
        paths = sorted(path for path in (self.folder / ROWS).glob(PARTS) if path.stem in counting)
        parts = [_read(paths[first : first + AT_ONCE]) for first in range(0, len(paths), AT_ONCE)]
        parts = [part for part in parts if len(part["key"])]
        if not parts:
            return {}
        columns = by_kind({name: np.concatenate([part[name] for part in parts]) for name in COLUMNS})
        order = np.lexsort((columns["parameter"], columns["start"], columns["vehicle"]))
        return {name: values[order] for name, values in columns.items()}

    def knowledge(self, most: int = MOST_KNOWN) -> list[tuple[str, LogKnowledge]]:
        """Return what each log says in the terms of every basis, with its vehicle; passes unreadable files.

        Args:
            most: logs; of more, each vehicle has equally many, drawn by the hash that names them.
        """
        found = []
        for path in _spread(self.folder / KNOWLEDGE, most, self._counting()):
            with contextlib.suppress(ValueError, OSError):
                found.append((unquote(path.parent.name.removeprefix("vehicle=")), _knowledge(path)))
        return found

    def unusable(self) -> list[dict[str, Any]]:
        """Return log, vehicle and failure of every log that could not be used, in order of the log."""
        counting = self._counting()
        found = [_unusable(p) for p in (self.folder / UNUSABLE).glob("*.json") if p.stem in counting]
        return sorted(found, key=lambda entry: str(entry["log"]))

    def mend(self) -> list[str]:
        """Set files aside that cannot be read, so that their logs are learned again; return what to say.

        Raises:
            OutputError: one cannot be moved.
        """
        said = []
        for kind, pattern, read in (
            (ROWS, PARTS, _check_rows),
            (KNOWLEDGE, "vehicle=*/*.json", _knowledge),
            (UNUSABLE, "*.json", _unusable),
        ):
            for path in sorted((self.folder / kind).glob(pattern)):
                if not _KEY.fullmatch(path.stem):
                    continue
                try:
                    read(path)
                except Exception as problem:  # pyarrow has errors of its own
                    self._set_aside(path)
                    reason = " ".join(str(problem).split())[:200] or type(problem).__name__
                    said.append(
                        f"{path}: cannot be read ({reason}); it was set aside, its log is learned again"
                    )
        return said

    def _set_aside(self, path: Path) -> None:
        """Move a file away, and with it all that was learned of its log."""
        aside = self.folder / SET_ASIDE
        with output_errors(aside):
            aside.mkdir(parents=True, exist_ok=True)
            for each in (path, *(self.folder / ROWS).glob(f"vehicle=*/month=*/{path.stem}.parquet")):
                if each.exists():
                    each.replace(aside / each.name)


def _spread(folder: Path, most: int, counting: set[str]) -> list[Path]:
    """Return the files that count, in order; of more than `most`, equally many of each vehicle."""
    paths = sorted(path for path in folder.glob("vehicle=*/*.json") if path.stem in counting)
    if len(paths) <= most:
        return paths
    place = Counter[str]()  # of a file among those of its vehicle
    ordered: list[tuple[int, Path]] = []
    for path in paths:
        ordered.append((place[path.parent.name], path))
        place[path.parent.name] += 1
    return sorted(path for _, path in sorted(ordered)[:most])


def folder_name(vehicle: str) -> str:
    """Return a vehicle's name as a folder bears it: one that is too long ends with its hash."""
    name = quote(vehicle, safe="")
    if len(name) <= LONGEST_NAME:
        return name
    end = 0
    while len(quote(vehicle[: end + 1], safe="")) <= LONGEST_NAME - len(_text_hash("")[:16]) - 1:
        end += 1
    return f"{quote(vehicle[:end], safe='')}~{_text_hash(vehicle)[:16]}"


def _check_rows(path: Path) -> None:
    """Raise where the rows of a log cannot be read, or a number is none."""
    table = _read([path])
    for name in ("start", "seconds", "distance", "value", "std"):
        if not len(table[name]) or not np.isfinite(table[name].astype(float)).all():
            raise ValueError(f"{name} is missing or not finite")


def _knowledge(path: Path) -> LogKnowledge:
    return knowledge_from(path.read_text(encoding="utf-8"))


def _unusable(path: Path) -> dict[str, Any]:
    """Return what stands in a file of an unusable log.

    Raises:
        ValueError: it is not such a file.
    """
    found = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(found, dict) or not all(
        isinstance(found.get(name), str) for name in ("log", "vehicle", "failure")
    ):
        raise ValueError("not the record of a log")
    return found


def _text_hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _read(paths: list[Path]) -> dict[str, NDArray[Any]]:
    """Return the columns of some logs; vehicle and month are in the names of their folders."""
    import pyarrow as pa
    import pyarrow.dataset as dataset

    types = {name: pa.string() for name in _TEXTS} | {"good": pa.bool_()}
    schema = pa.schema([(name, types.get(name, pa.float64())) for name in COLUMNS])  # older files lack some
    of_folders = pa.schema([schema.field("vehicle"), schema.field("month")])
    partitioned = dataset.partitioning(flavor="hive", schema=of_folders)
    files = dataset.dataset(list(map(str, paths)), schema=schema, format="parquet", partitioning=partitioned)
    table = files.to_table(list(COLUMNS))
    return {
        name: np.array([intern(text or "") for text in table[name].to_pylist()], dtype=object)
        if pa.types.is_string(table[name].type)
        else table[name].to_numpy()
        for name in COLUMNS
    }


def _write(path: Path, learned: LogRows) -> None:
    import pyarrow as pa
    import pyarrow.parquet as parquet

    of_log = {name: getattr(learned, name) for name in (*_OF_LOG, *_OF_VERDICT)} | asdict(learned.numbers)
    parquet.write_table(pa.Table.from_pylist([of_log | asdict(row) for row in learned.rows]), path)
