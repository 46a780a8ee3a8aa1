# SPDX-License-Identifier: Apache-2.0
"""Sources that clang-tidy reads as one text, and what it says names the source."""

import json
from pathlib import Path

import pytest
from tools import run_tidy
from tools.run_tidy import NOT_COMPILED, Source, groups_of, said_of, sources_of, written

COMMAND = ("c++", "-std=c++20")


def source(folder: Path, name: str, *lines: str, command: tuple[str, ...] = COMMAND) -> Source:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join((*lines, "")), encoding="utf-8")
    return Source(path, command)


def names_of(sources: list[Source]) -> list[list[str]]:
    return [sorted(each.path.stem for each in group.sources) for group in groups_of(sources)]


def test_eight_sources_of_a_folder_are_read_together_those_of_other_folders_and_flags_apart(
    tmp_path: Path,
) -> None:
    names = [f"{number:02}" for number in range(10)]
    flags = (*COMMAND, "-mavx2")
    many = [
        source(tmp_path, f"a/{name}.cpp", "int one();", command=flags if name == "03" else COMMAND)
        for name in names
    ]
    other = source(tmp_path, "b/one.cpp", "int one();")
    groups = sorted(names_of([*many, other]))
    assert groups == [[each for each in names[:8] if each != "03"], ["03"], ["08", "09"], ["one"]]


def test_each_line_knows_where_it_stands_and_a_header_is_read_once(tmp_path: Path) -> None:
    one = source(tmp_path, "one.cpp", "#include <vector>", "int one();")
    two = source(tmp_path, "two.cpp", "#include <vector>", "#include <span>", "int two();")
    (group,) = groups_of([one, two])
    text = tmp_path / "together.cpp"
    origins = written(group, text)
    assert text.read_text().splitlines() == [
        "#include <vector>",
        "int one();",
        "",
        "#include <span>",
        "int two();",
    ]
    assert origins == [(one.path, 1), (one.path, 2), (two.path, 1), (two.path, 2), (two.path, 3)]


def test_a_command_is_read_without_its_files(tmp_path: Path) -> None:
    path = source(tmp_path, "cpp/src/lie/se2.cpp", "int a;").path
    command = f"c++ -Iinclude -O0 -MD -MT a.o -MF a.d -o a.o -c {path}"
    entries = [
        {"file": str(path), "command": command},
        {"file": "cpp/tests/main.cpp", "command": "c++ -o m.o"},
    ]
    (tmp_path / "commands.json").write_text(json.dumps(entries))
    assert sources_of(tmp_path / "commands.json") == [Source(path, ("c++", "-Iinclude", "-O0"))]


def test_what_is_said_of_a_text_names_the_source_and_its_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (group,) = groups_of([source(tmp_path, "one.cpp", "int one();"), source(tmp_path, "two.cpp", "int x;")])
    text, header = tmp_path / "together.cpp", f"{tmp_path}/a.hpp:2:1: note: here\n    2 | int a;"
    said = f"{text}:2:1: error: bad\n    2 | int x;\n      | ^\n{header}"
    monkeypatch.setattr(run_tidy, "run", lambda *_: said)
    place = f"{tmp_path}/two.cpp:1:1: error: bad\n    1 | int x;\n      | ^\n{header}"
    assert said_of(group, text, written(group, text)) == place


def test_sources_that_do_not_compile_together_are_read_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (group,) = groups_of([source(tmp_path, "one.cpp", "int one();"), source(tmp_path, "two.cpp", "int x;")])
    asked = []

    def run(_: Path, files: list[Path]) -> str:
        asked.append([each.name for each in files])
        return NOT_COMPILED if len(asked) == 1 else ""

    monkeypatch.setattr(run_tidy, "run", run)
    text = tmp_path / "together.cpp"
    assert said_of(group, text, written(group, text)) == ""
    assert asked == [["together.cpp"], ["one.cpp", "two.cpp"]]
