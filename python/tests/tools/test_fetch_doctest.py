# SPDX-License-Identifier: Apache-2.0
"""The header of doctest is taken out of a source package only when it is the expected file."""

import hashlib
import io
import tarfile
from pathlib import Path

import pytest
from tools import fetch_doctest


def archive(folder: Path, name: str, content: bytes) -> Path:
    """Write a source package that holds one file."""
    path = folder / "package.tar.gz"
    with tarfile.open(path, "w:gz") as tar:
        info = tarfile.TarInfo(name)
        info.size = len(content)
        tar.addfile(info, io.BytesIO(content))
    return path


def test_the_expected_header_is_returned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fetch_doctest, "SHA256", hashlib.sha256(b"header").hexdigest())
    assert fetch_doctest.header_from(archive(tmp_path, fetch_doctest.MEMBER, b"header")) == b"header"


def test_another_header_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is not the expected file"):
        fetch_doctest.header_from(archive(tmp_path, fetch_doctest.MEMBER, b"another"))


def test_a_package_without_the_header_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="has no"):
        fetch_doctest.header_from(archive(tmp_path, "elsewhere.h", b"header"))


def test_a_failed_download_is_one_line_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(folder: Path) -> Path:
        raise OSError("no network")

    monkeypatch.setattr(fetch_doctest, "compiler_has_doctest", lambda: False)
    monkeypatch.setattr(fetch_doctest, "download", refuse)
    assert fetch_doctest.main(tmp_path / "include") == 2
    assert capsys.readouterr().err == "error: cannot fetch doctest: no network; install doctest-dev instead\n"
    assert not (tmp_path / "include").exists()


def test_nothing_is_fetched_where_the_compiler_has_doctest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fetch_doctest, "compiler_has_doctest", lambda: True)
    assert fetch_doctest.main(tmp_path / "include") == 0
    assert not (tmp_path / "include").exists()
