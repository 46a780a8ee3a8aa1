# SPDX-License-Identifier: Apache-2.0
"""Logs on a server are learned as others, fetched one by one, removed, and fetched again only if changed."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Generator, Iterable, Iterator
from pathlib import Path

import pytest
from fleet.test_learned_rows import write_log
from logs.file_server import Server, serving

from slipwise.fleet import LogTask, Outcome, Store, find_logs, learn_task
from slipwise.fleet.learn_fleet import Count, learn_fleet
from slipwise.logs import remote

pytest.importorskip("aiohttp")
pytest.importorskip("fsspec")

SHORT = b"t,speed\n0,1\n"  # no log of motion


class Here:
    """Learns in this process, and looks at what lies in its temporary folder after each log."""

    def __init__(self) -> None:
        self.left: list[str] = []

    def run(self, tasks: Iterable[LogTask]) -> Generator[Outcome, None, None]:
        for task in tasks:
            rows = learn_task(task)
            self.left += [path.name for path in Path(tempfile.gettempdir()).iterdir()]
            yield Outcome(task, rows, rows.failure)


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    with serving() as shared:
        yield shared


def _learned(folder: Path, *places: str) -> tuple[Count, Here]:
    here = Here()
    return learn_fleet(find_logs(places), Store(folder), here), here


@pytest.mark.slow
def test_log_on_a_server_gives_the_rows_of_the_same_log_here(server: Server, tmp_path: Path) -> None:
    (tmp_path / "red").mkdir()
    log = write_log(tmp_path / "red" / "a.csv", 1, 30.0)
    server.files["/logs/red/a.csv"] = log.read_bytes()
    server.headers = {"ETag": "1", "Last-Modified": "Wed, 21 Oct 2015 07:28:00 GMT"}
    there, here = Store(tmp_path / "there"), Store(tmp_path / "here")
    count, at_work = _learned(there.folder, f"{server.address}/logs/red/a.csv?key=secret")
    _learned(here.folder, str(log))
    assert (count.learned, count.failed, at_work.left) == (1, (), [])
    expected = here.table()
    for name, values in there.table().items():
        if name not in ("start", "month"):
            assert values.tolist() == expected[name].tolist()
    assert there.table()["start"][0] == 1445412480.0  # when the server says that it was changed
    assert "secret" not in "".join(path.read_text("latin-1") for path in there.folder.rglob("*.*"))


def test_unchanged_address_is_not_fetched_again(server: Server, tmp_path: Path) -> None:
    server.files["/red/a.csv"], server.headers = SHORT, {"ETag": "1"}
    url = f"{server.address}/red/a.csv"
    assert _learned(tmp_path, url)[0].unusable == 1
    assert (_learned(tmp_path, url)[0].known, len(server.asked)) == (1, 1)
    server.files["/red/a.csv"], server.headers = SHORT + b"1,1\n", {"ETag": "2"}
    assert (_learned(tmp_path, url)[0].unusable, len(server.asked)) == (1, 2)


def test_address_whose_server_tells_no_version_is_fetched_but_not_learned_again(
    server: Server, tmp_path: Path
) -> None:
    server.files |= {"/red/a.csv": SHORT, "/blue/copy.csv": SHORT}
    urls = [f"{server.address}/red/a.csv?signed=1", f"{server.address}/blue/copy.csv"]
    first = _learned(tmp_path, *urls)[0]
    assert (first.unusable, first.known) == (1, 1)  # a copy is the same log
    assert [why.partition(", ")[2] for _, why in first.copies] == [
        "and counts once, not for both blue and red"
    ]
    again = _learned(tmp_path, f"{server.address}/red/a.csv?signed=2")[0]
    assert (again.unusable, again.known) == (0, 1)
    assert server.asked[-1] == "/red/a.csv?signed=2"


def test_what_cannot_be_fetched_costs_its_own_log_only_and_is_tried_again(
    server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote, "MOST_FETCHED", 1.0)
    server.files |= {"/red/a.csv": SHORT, "/red/large.csv": bytes(3 << 20)}
    names = ("a.csv", "gone.csv?key=secret", "large.csv", "locked.csv")
    found = find_logs([f"{server.address}/red/{name}" for name in names])
    for asked in (1, 1):
        here = Here()
        count = learn_fleet(found, Store(tmp_path / "out"), here)
        assert count.unusable + count.known == asked
        why = {log.rpartition("/")[2]: reason for log, reason in count.failed}
        assert sorted(why) == ["gone.csv", "large.csv", "locked.csv"]
        assert "no such file on the server" in why["gone.csv"]
        assert "more than 1 MiB" in why["large.csv"]
        assert "403" in why["locked.csv"]
        assert "secret" not in json.dumps(why)
        assert here.left == []
    assert not server.asked.count("/red/large.csv")
