# SPDX-License-Identifier: Apache-2.0
"""`make help` fits a screen and names every public target; containers call targets that exist."""

import json
import re
import shutil
import subprocess

import pytest
from tools.requirements import ROOT

MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
TARGETS = set(re.findall(r"^([a-z][a-z-]*):", MAKEFILE, re.MULTILINE))
README_COMMANDS = {"demo", "test"}  # the two of README.md


def called(commands: str) -> set[str]:
    """Return the targets that `commands` hand to make."""
    return set(re.findall(r"(?:^|&& *)make ([a-z-]+)", commands, re.MULTILINE))


def dockerfile_commands() -> list[str]:
    """Return what the instructions RUN and CMD of the Dockerfile run."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8").replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    instructions = [line.split(maxsplit=1) for line in lines]
    assert {name for name, _ in instructions} <= {"FROM", "RUN", "WORKDIR", "COPY", "CMD"}
    runs = [rest for name, rest in instructions if name == "RUN"]
    return [*runs, *(" ".join(json.loads(rest)) for name, rest in instructions if name == "CMD")]


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
def test_help_fits_a_screen_and_names_every_public_target() -> None:
    text = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    lines = [line for line in text.splitlines() if line.startswith("  make ")]
    assert len(text.splitlines()) <= 24
    assert {line.split()[1] for line in lines} == {
        target for target in TARGETS if not target.startswith("lint-")
    }


def test_every_target_that_is_no_file_is_declared_so() -> None:
    phony = re.search(r"^\.PHONY: ((?:.*\\\n)*.*)$", MAKEFILE, re.MULTILINE)
    assert phony is not None
    assert set(phony[1].replace("\\\n", " ").split()) == TARGETS | {"FORCE"}


def test_the_dockerfile_runs_the_two_commands_of_the_readme_and_no_other_target() -> None:
    commands = dockerfile_commands()
    assert set().union(*map(called, commands)) == README_COMMANDS <= TARGETS
    assert [command for command in commands if not called(command)] == [commands[0]]  # the system's packages


def test_the_development_container_is_that_of_the_dockerfile_and_runs_the_two_commands() -> None:
    folder = ROOT / ".devcontainer"
    content = json.loads((folder / "devcontainer.json").read_text(encoding="utf-8"))
    build = content["build"]
    assert (folder / build["dockerfile"]).resolve() == ROOT / "Dockerfile"
    assert f" AS {build['target']}\n" in (ROOT / "Dockerfile").read_text(encoding="utf-8")
    assert called(content["postCreateCommand"]) == README_COMMANDS


def test_the_readme_names_both_commands() -> None:
    assert called((ROOT / "README.md").read_text(encoding="utf-8")) >= README_COMMANDS
