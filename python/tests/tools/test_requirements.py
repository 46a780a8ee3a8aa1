# SPDX-License-Identifier: Apache-2.0
"""What `make` installs before the build is read from pyproject.toml, and every version of it is pinned."""

import re
import tomllib

import pytest
from tools.requirements import ROOT, requirements

from slipwise.extras import to_install

#: Extras behind the project's name, or behind the dot of a checkout: slipwise[gp], ".[plot,sim]".
EXTRAS = re.compile(r"(?:\bslipwise|(?<![\w\])])\.)\[([a-z][a-z, -]*)\]")
PROJECT = {
    "build-system": {"requires": ["builder>=1"]},
    "project": {
        "name": "robot",
        "dependencies": ["numpy>=2"],
        "optional-dependencies": {"plot": ["drawing>=1"], "sim": ["mujoco>=3"], "all": ["robot[plot,sim]"]},
    },
    "dependency-groups": {"dev": ["pytest>=9"]},
}


@pytest.mark.parametrize(
    ("part", "expected"),
    [("build", "builder>=1"), ("run", "numpy>=2"), ("sim", "mujoco>=3"), ("dev", "pytest>=9")],
)
def test_each_part_is_read_from_its_own_table(part: str, expected: str) -> None:
    assert requirements(PROJECT, part) == [expected]


def test_an_extra_that_names_others_stands_for_theirs() -> None:
    assert requirements(PROJECT, "all") == ["drawing>=1", "mujoco>=3"]


def test_every_extra_that_a_page_or_an_error_names_exists() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")]
    named = {
        extra.strip()
        for page in pages
        for names in EXTRAS.findall(page.read_text(encoding="utf-8"))
        for extra in names.split(",")
    }
    for source in (ROOT / "python/slipwise").rglob("*.py"):
        named |= set(re.findall(r'to_install\("(\w+)"\)', source.read_text(encoding="utf-8")))
    assert {"live", "plot", "terrain"} <= named
    assert named <= set(project["project"]["optional-dependencies"])


def test_what_an_extra_needs_is_installed_by_name() -> None:
    assert to_install("live") == "pip install 'starlette>=0.40' 'uvicorn>=0.30'"


def test_extras_are_found_in_text(subtests: pytest.Subtests) -> None:
    for text, names in [
        ('pip install "slipwise[gp]"', ["gp"]),
        ("needs slipwise[gp, sim]", ["gp, sim"]),
        ('`".[plot]"`', ["plot"]),
        ("pip install .[sim]", ["sim"]),
        ("slipwise[0]", []),
        ("path.[sim]", []),
    ]:
        with subtests.test(text=text, names=names):
            assert EXTRAS.findall(text) == names


def test_an_unknown_part_is_refused() -> None:
    with pytest.raises(KeyError, match="docs"):
        requirements(PROJECT, "docs")


def test_every_requirement_has_a_pinned_version(subtests: pytest.Subtests) -> None:
    for part in [
        "build",
        "native",
        "run",
        "gp",
        "plot",
        "packages/slipwise-sim",
        "packages/slipwise-thesis",
        "test",
        "lint",
        "bench",
    ]:
        with subtests.test(part=part):
            project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
            lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
            pinned = {line.split("==")[0] for line in lines if "==" in line}
            for requirement in requirements(project, part):
                name = re.split(r"[<>=!~\[; ]", requirement)[0].lower().replace("_", "-")
                assert name in pinned
