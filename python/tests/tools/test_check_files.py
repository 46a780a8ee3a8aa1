# SPDX-License-Identifier: Apache-2.0
"""The file checker finds long files, missing licence lines and vague names among the tracked sources."""

import subprocess
from pathlib import Path

import pytest
from tools.check_files import MAX_LINES, check, faults_of

PYTHON = "# SPDX-License-Identifier: Apache-2.0\n"
CPP = "// SPDX-License-Identifier: Apache-2.0\n"


def test_a_file_at_the_limit_is_accepted_and_one_line_more_is_not() -> None:
    assert faults_of("a/long.py", PYTHON + "x = 1\n" * (MAX_LINES - 1)) == []
    (fault,) = faults_of("a/long.py", PYTHON + "x = 1\n" * MAX_LINES)
    assert "401 lines" in fault


def test_a_source_without_the_licence_line_on_top_is_refused(subtests: pytest.Subtests) -> None:
    for path, text in [
        ("a/b.py", ""),
        ("a/b.py", '"""No licence."""\n'),
        ("a/b.hpp", PYTHON),
        ("a/b.cpp", "\n" + CPP),
        ("CMakeLists.txt", "project(x)\n"),
        ("tools/run.sh", "#!/bin/sh\necho\n"),
        (".ci/run", "#!/bin/sh\n"),
    ]:
        with subtests.test(path=path, text=text):
            (fault,) = faults_of(path, text)
            assert "does not start with" in fault


def test_the_licence_line_may_follow_the_interpreter_line() -> None:
    assert faults_of("tools/run.sh", "#!/bin/sh\n" + PYTHON) == []


def test_files_that_are_no_sources_are_not_looked_at() -> None:
    assert faults_of("docs/long.md", "text\n" * 1000) == []


@pytest.mark.parametrize("name", ["utils.py", "helpers.hpp", "common.cpp", "Base.py"])
def test_a_name_that_says_nothing_is_refused(name: str) -> None:
    (fault,) = faults_of(f"a/{name}", CPP if name.endswith("pp") else PYTHON)
    assert "name the file after the concept" in fault


def test_only_files_that_git_does_not_ignore_are_checked(tmp_path: Path) -> None:
    subprocess.run(["git", "init", "--quiet", str(tmp_path)], check=True)
    (tmp_path / ".gitignore").write_text("ignored.py\n", encoding="utf-8")
    for name in ("ignored.py", "seen one.py"):
        (tmp_path / name).write_text("pass\n", encoding="utf-8")
    (fault,) = check(tmp_path)
    assert fault.startswith("seen one.py: ")


def test_a_retired_word_is_refused_in_the_product_with_what_replaces_it(subtests: pytest.Subtests) -> None:
    for text in [
        "wanders",
        "SlipWander",
        "check_wander",
        "its belief",
        "kept_beliefs",
        "ColouredSlip",
        "learn anew",
    ]:
        with subtests.test(text=text):
            source = f"{PYTHON}# {text}\n"
            (fault,) = faults_of("python/slipwise/a.py", source)
            assert "is retired; write " in fault
            assert faults_of("python/tests/a.py", source) == []


@pytest.mark.parametrize("text", ["a new one", "coloured noise", "a command and its chain", "yaw and error"])
def test_other_words_are_not(text: str) -> None:
    assert faults_of("python/slipwise/a.py", f"{PYTHON}# {text}\n") == []
