# SPDX-License-Identifier: Apache-2.0
"""Reads the track points of GPX files, as positions without headings."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, XMLPullParser

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.satellite_track import Fix, track_stream
from slipwise.logs.streams import RawStream

_PIECE = 1 << 16  # characters that are parsed at once
_DEEPEST = 100  # elements in each other; GPX has five, and extensions a few more


def is_gpx(text: str) -> bool:
    """Say whether a text is GPX."""
    return text.lstrip().startswith("<") and "<gpx" in text[:2000]


def read_gpx(path: Path, text: str, tally: Tally) -> tuple[RawStream, tuple[str, ...]]:
    """Return the points of all tracks; of a file that is cut off, those before the cut.

    Points of routes and way points are no measurements and are not read. (GPX 1.1, topografix.com)

    Raises:
        LogError: the file declares a document type, which may hold entities that expand without end.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        advice = "GPX needs none: take the declaration out"
        raise LogError("the file declares a document type", where=str(path), advice=advice)
    points = enumerate(_points(path, text, tally), start=1)
    return track_stream(path, "track point", ((number, _fix(point)) for number, point in points), tally), ()


def _points(path: Path, text: str, tally: Tally) -> Iterator[Element]:
    """Yield track points as they end, and forget them; count the place from where on it is no XML."""
    parser: XMLPullParser[Element] = XMLPullParser(("start", "end"))  # nothing is declared that could expand
    depth = 0
    try:
        for start in range(0, len(text), _PIECE):
            parser.feed(text[start : start + _PIECE])
            for event in parser.read_events():
                kind, element = event[0], event[-1]
                if not isinstance(element, Element):
                    continue
                depth += 1 if kind == "start" else -1
                if depth > _DEEPEST:
                    where, advice = str(path), "write the tracks again as GPX 1.1"
                    raise LogError(f"more than {_DEEPEST} elements in each other", where=where, advice=advice)
                if kind == "end" and _name(element) == "trkpt":
                    yield element
                    element.clear()
        parser.close()
    except ParseError as error:
        tally.add("broken-row", f"the file is no XML from here on ({error})", count=1, where=path.name)


def _fix(point: Element) -> Fix | None:
    inside = {_name(child): (child.text or "").strip() for child in point}
    try:
        at = datetime.fromisoformat(inside["time"])
        seconds = (at if at.tzinfo else at.replace(tzinfo=UTC)).timestamp()
        height = float(inside.get("ele") or "nan")
        return seconds, float(point.get("lat", "")), float(point.get("lon", "")), height
    except (KeyError, ValueError, OverflowError):
        return None


def _name(element: Element) -> str:
    """Return the name of an element without that of its namespace."""
    return element.tag.rpartition("}")[2]
