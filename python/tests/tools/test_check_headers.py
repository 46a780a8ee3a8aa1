# SPDX-License-Identifier: Apache-2.0
"""Headers that are compiled together are each seen as if alone."""

import shutil
from itertools import pairwise
from pathlib import Path

import pytest
from tools.check_headers import ROOT, chains, compile_chain, headers_of


def test_each_header_stands_in_one_chain_after_headers_that_it_includes() -> None:
    within = headers_of(ROOT)
    found = chains(within)
    assert sorted(name for chain in found for name in chain) == sorted(within)
    assert all(first in within[then] for chain in found for first, then in pairwise(chain))
    assert len(found) < 0.6 * len(within)


def test_chains_are_as_few_as_they_can_be() -> None:
    a, b, c = "a.hpp", "b.hpp", "c.hpp"
    within = {a: frozenset[str](), b: frozenset({a}), c: frozenset({a, b}), "d.hpp": frozenset({a})}
    assert sorted(map(tuple, chains(within))) in ([(a, b, c), ("d.hpp",)], [(a, "d.hpp"), (b, c)])


def test_a_header_that_is_not_complete_is_found_in_its_chain(tmp_path: Path) -> None:
    compiler = shutil.which("c++")
    if compiler is None:
        pytest.skip("there is no C++ compiler")
    (tmp_path / "one.hpp").write_text("#pragma once\nstruct One {};\n")
    (tmp_path / "two.hpp").write_text('#pragma once\n#include "one.hpp"\nstruct Two { Three three; };\n')
    command = [compiler, "-std=c++20", f"-I{tmp_path}"]
    assert compile_chain(command, ["one.hpp"], None) == ""
    assert "Three" in compile_chain(command, ["one.hpp", "two.hpp"], None)
