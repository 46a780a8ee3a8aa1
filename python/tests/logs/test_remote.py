# SPDX-License-Identifier: Apache-2.0
"""Logs on a server are copied within a limit, and errors are one line that gives no secret away."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
from logs.file_server import Server, serving

from slipwise.addresses import remote_url, shown
from slipwise.errors import LogError
from slipwise.logs import LogOptions, open_log, remote
from slipwise.logs.left_out import Tally
from slipwise.logs.pose_file import read_pose_file
from slipwise.logs.remote import lent, remote_version, staged
from slipwise.logs.survey import survey_log

fsspec = pytest.importorskip("fsspec")
pytestmark = pytest.mark.skipif(find_spec("aiohttp") is None, reason="reading logs on servers needs aiohttp")

ROWS = "".join(f"{0.1 * k:.1f},0.5,0.1,{0.05 * k:.3f},0,0\n" for k in range(50))
DRIVE = ("t,odo_v,odo_omega,x,y,yaw\n" + ROWS).encode()


@pytest.fixture
def server() -> Iterator[Server]:
    with serving() as shared:
        yield shared


@pytest.mark.parametrize("silent", [False, True])
def test_a_log_on_a_server_is_read_as_one_on_this_machine(
    server: Server, tmp_path: Path, *, silent: bool
) -> None:
    server.files["/drives/a.csv"], server.silent = DRIVE, silent
    (tmp_path / "a.csv").write_bytes(DRIVE)
    here, there = open_log(tmp_path / "a.csv"), open_log(f"{server.address}/drives/a.csv")
    assert there.sources[0].sha256 == here.sources[0].sha256
    assert there.sources[0].path == f"{server.address}/drives/a.csv"
    assert [run.name for run in there.runs] == [run.name for run in here.runs]


def test_a_file_is_fetched_once_for_all_that_read_it(server: Server) -> None:
    server.files["/a.csv"] = DRIVE
    path = Path(f"{server.address}/a.csv")  # as the command line gives it, with one slash
    assert survey_log(path, LogOptions()).path == f"{server.address}/a.csv"
    open_log(path)
    assert server.asked == ["/a.csv"]


def test_poses_beside_a_log_may_lie_on_a_server(server: Server) -> None:
    server.files["/p.txt"] = b"0.5 1 2 3 0 0 0 1\n"
    assert read_pose_file(Path(f"{server.address}/p.txt"), {}, Tally()).stream.t.tolist() == [0.5]


@pytest.mark.parametrize("silent", [False, True])
def test_more_than_is_allowed_is_not_fetched(
    server: Server, monkeypatch: pytest.MonkeyPatch, *, silent: bool
) -> None:
    monkeypatch.setattr(remote, "MOST_FETCHED", 1.0)
    server.files["/a.csv"], server.silent = DRIVE + bytes(4 << 20), silent
    with pytest.raises(LogError, match=r"more than 1 MiB .*a\.csv.*copy the file"):
        open_log(f"{server.address}/a.csv")
    assert silent or not server.asked


def test_a_file_that_comes_cut_off_is_refused_and_fetched_anew(server: Server) -> None:
    server.files["/a.csv"], server.cut = DRIVE, True
    with pytest.raises(LogError, match=r"cannot be fetched|cut off"):
        open_log(f"{server.address}/a.csv")
    server.cut = False
    assert len(open_log(f"{server.address}/a.csv").runs[0].poses) == 50


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("/none.csv?key=secret", "no such file on the server .*check the address"),
        ("/locked.csv?key=secret", "cannot be fetched: .*403"),
        ("/empty.csv?key=secret", "the file is empty"),
        ("/a.mcap?key=secret", "not a bag: wrong magic bytes"),
    ],
)
def test_what_cannot_be_read_is_said_in_a_line_without_the_key(
    server: Server, place: str, message: str
) -> None:
    server.files |= {"/empty.csv": b"", "/a.mcap": DRIVE}
    with pytest.raises(LogError, match=message) as caught:
        open_log(f"{server.address}{place}".replace("http://", "http://me:secret@"))
    assert "secret" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_server_that_is_not_there_is_an_error_of_one_line() -> None:
    with pytest.raises(
        LogError, match=r"cannot be fetched: ClientConnector.*\(http://127\.0\.0\.1:1/a\.csv\)"
    ):
        open_log("http://127.0.0.1:1/a.csv")


def test_keys_in_an_address_do_not_reach_the_log(server: Server) -> None:
    server.files["/a.csv"] = DRIVE
    log = open_log(f"{server.address}/a.csv?X-Amz-Signature=secret")
    assert log.sources[0].path == f"{server.address}/a.csv"
    assert "secret" not in repr(log.sources) + repr(log.notes) + repr([run.name for run in log.runs])
    assert server.asked == ["/a.csv?X-Amz-Signature=secret"]


def test_object_stores_are_read_through_their_own_file_system(monkeypatch: pytest.MonkeyPatch) -> None:
    from fsspec.implementations.memory import MemoryFileSystem

    class Store(MemoryFileSystem):  # type: ignore[misc]
        @classmethod
        def _strip_protocol(cls, path: str) -> str:
            return str(super()._strip_protocol(path.replace("gs://", "memory://")))

    monkeypatch.setattr(fsspec, "filesystem", lambda scheme, **_: {"gs": Store}[scheme]())
    Store().pipe("/bucket/drives/a.csv", DRIVE)
    log = open_log(Path("gs://bucket/drives/a.csv"))
    assert (len(log.runs[0].poses), log.sources[0].path) == (50, "gs://bucket/drives/a.csv")
    with pytest.raises(LogError, match=r"a folder on a server .*name the files"):
        open_log("gs://bucket/drives")


def test_a_store_whose_package_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(*_: object, **__: object) -> None:
        raise ImportError("Install s3fs to access S3")

    monkeypatch.setattr(fsspec, "filesystem", missing)
    with pytest.raises(LogError, match=r"s3:// needs another package .*fsspec.* s3fs"):
        staged("s3://bucket/none.csv")


def test_an_address_is_told_from_a_file(subtests: pytest.Subtests) -> None:
    for path, url in [
        ("https:/host/a.csv", "https://host/a.csv"),
        ("s3://bucket/a.csv", "s3://bucket/a.csv"),
        ("file:///etc/passwd", None),
        ("simplecache::https://host/a", None),
        ("runs/https:/host", None),
        ("/https://host", None),
        ("https:", None),
    ]:
        with subtests.test(path=path, url=url):
            assert remote_url(path) == url
            assert remote_url(Path(path)) == url


def test_a_folder_of_this_machine_goes_before_an_address(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "https:/host").mkdir(parents=True)
    (tmp_path / "https:/host/a.csv").write_bytes(DRIVE)
    assert len(open_log("https://host/a.csv").runs[0].poses) == 50


def test_names_of_files_are_shown_as_they_are() -> None:
    assert shown(Path("a?b@c.csv")) == "a?b@c.csv"


def test_a_lent_copy_serves_all_that_read_it_and_is_gone_at_the_end(server: Server) -> None:
    server.files["/a.csv"] = DRIVE
    with lent(f"{server.address}/a.csv") as copy:
        assert len(open_log(f"{server.address}/a.csv").runs[0].poses) == 50
        assert server.asked == ["/a.csv"]
    assert not copy.exists()
    assert not copy.parent.exists()
    with lent(f"{server.address}/a.csv"):
        assert server.asked == ["/a.csv"] * 2


def test_another_version_has_another_tag(server: Server) -> None:
    server.files["/a.csv"] = DRIVE
    url = f"{server.address}/a.csv"
    assert remote_version(url).tag == ""  # nothing but a length tells no versions apart
    server.headers = {"ETag": '"1"', "Last-Modified": "Wed, 21 Oct 2015 07:28:00 GMT"}
    first = remote_version(url)
    assert first.changed == 1445412480.0
    assert remote_version(url) == first
    server.headers = {"ETag": '"2"'}
    assert remote_version(url).tag not in ("", first.tag)
    assert not server.asked
    with pytest.raises(LogError, match="no such file on the server"):
        remote_version(f"{server.address}/none.csv")


def test_a_server_that_sends_byte_by_byte_is_given_up_in_proportion_to_the_size(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote, "_PATIENCE", 0.4)
    server.files["/a.csv"], server.pause = DRIVE, 0.05
    with pytest.raises(LogError, match=r"too slow: \d+ bytes|cannot be fetched: .*Timeout"):
        open_log(f"{server.address}/a.csv")
    assert server.sent * server.pause < 5.0  # s of the server's; what a busy machine takes is not counted
