# SPDX-License-Identifier: Apache-2.0
"""The page that maps the thesis to the code is complete, and every name on it exists."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from importlib import import_module

from python.tests.docs.pages import ROOT, code_words, table_rows

PAGE = ROOT / "docs/thesis-map.md"
#: How far the thesis numbers its equations, figures and tables, chapter by chapter.
EQUATIONS = {2: 9, 3: 11, 4: 13, 5: 19, 6: 18}
FIGURES = {2: 1, 3: 1, 4: 10, 5: 3, 6: 7, 8: 1}
TABLES = {5: 1, 6: 2}
SECTIONS = {"8.1", "8.1.1", "8.2", "8.3", "8.4"}

PYTHON = re.compile(r"`(slipwise(?:_sim|_thesis)?(?:\.\w+)+)`")
CPP = re.compile(r"\[`(\w+)`\]\(\.\./((?:packages/slipwise-thesis/)?cpp/include/[\w/]+\.hpp)\)")
MADE = re.compile(r"(?:figure|table) `([a-z0-9-]+)`")


def numbered() -> set[str]:
    """Return every number of the thesis as the page writes it."""
    found = set(SECTIONS)
    for pattern, counts in (("({}.{})", EQUATIONS), ("Figure {}.{}", FIGURES), ("Table {}.{}", TABLES)):
        for chapter, count in counts.items():
            found |= {pattern.format(chapter, number) for number in range(1, count + 1)}
    return found


def rows() -> Iterator[list[str]]:
    """Return the rows of all tables: number, what it is, names in the code, note."""
    text = PAGE.read_text(encoding="utf-8")
    for start in re.finditer(r"^\| (?:thesis|section) \|", text, re.MULTILINE):
        header = text[start.start() : text.index("\n", start.start())]
        yield from table_rows(text[start.start() :], header)


ROWS = list(rows())


def test_every_number_of_the_thesis_has_a_row_and_no_other_has() -> None:
    shown = [row[0] for row in ROWS]
    assert set(shown) == numbered()
    twice = {number for number in shown if shown.count(number) > 1}
    assert twice <= SECTIONS


def test_what_has_no_implementation_says_why() -> None:
    empty = {row[0]: row[3] for row in ROWS if row[2] == "–"}
    assert empty
    assert not {number for number, note in empty.items() if not note.startswith("none")}
    assert not {row[0] for row in ROWS if row[3].startswith("none") and row[0] not in empty}


def can_be_imported(name: str) -> bool:
    parts = name.split(".")
    for cut in range(len(parts) - 1, 0, -1):
        try:
            found = import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        for part in parts[cut:]:
            found = getattr(found, part, None)
        return found is not None
    return False


def test_python_names_can_be_imported() -> None:
    names = {name for row in ROWS for name in PYTHON.findall(" | ".join(row))}
    assert len(names) > 40
    assert not {name for name in names if not can_be_imported(name)}


def test_every_name_in_a_row_is_one_that_is_looked_for() -> None:
    known = re.compile(rf"(?:{PYTHON.pattern}|{CPP.pattern}|{MADE.pattern})")
    assert not {row[0]: row[2] for row in ROWS if row[2] != "–" and known.sub("", row[2]).strip(", ")}


def test_cpp_names_are_declared_in_their_headers() -> None:
    named = {pair for row in ROWS for pair in CPP.findall(row[2])}
    assert len(named) > 40
    gone = []
    for name, header in sorted(named):
        lines = (ROOT / header).read_text(encoding="utf-8").splitlines()
        code = "\n".join(line.split("//")[0] for line in lines if not line.startswith("#include"))
        if not re.search(rf"\b{name}\b", code):
            gone.append(f"{name} in {header}")
    assert not gone


@cache
def written_texts() -> tuple[frozenset[str], tuple[str, ...]]:
    """Return the strings of the reproduction's sources, and the starts of those put together of two."""
    sources = sorted((ROOT / "packages/slipwise-thesis/slipwise_thesis").glob("*.py"))
    nodes = [node for path in sources for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
    texts = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    joined = [node.values[0] for node in nodes if isinstance(node, ast.JoinedStr) and len(node.values) == 2]
    return frozenset(texts), tuple(str(first.value) for first in joined if isinstance(first, ast.Constant))


def key_is_written(key: str) -> bool:
    """Whether the reproduction's sources write this key, whole or put together of two strings."""
    texts, starts = written_texts()
    return key in texts or any(key.startswith(s) and s and key.removeprefix(s) in texts for s in starts)


def test_every_figure_named_is_made_under_the_number_of_its_row() -> None:
    named = [(key, row[0]) for row in ROWS for key in MADE.findall(row[2])]
    assert len(named) > 25
    for key, number in named:
        plain = f"equation {number.strip('()')}" if number.startswith("(") else number.lower()
        assert key.startswith(plain.replace(" ", "-").replace(".", "-")), (key, number)
    assert not {key for key, _ in named if not key_is_written(key)}
    assert not key_is_written("figure-9-9")


def test_figures_beyond_the_thesis_are_made() -> None:
    text = PAGE.read_text(encoding="utf-8")
    named = code_words(text[text.index("## Beyond the thesis") :])
    assert len(named) > 4
    assert not {key for key in named if not key_is_written(key)}


def test_every_erratum_is_linked_from_its_number() -> None:
    text = (ROOT / "docs/derivations/thesis.md").read_text(encoding="utf-8")
    notes = {row[0]: row[3] for row in ROWS}
    for where, *_ in table_rows(text, "| where | fault |"):
        for kind, number in re.findall(r"(Table )?(\d\.\d+)", where):
            key = f"Table {number}" if kind else f"({number})"
            assert "derivations/" in notes[key], f"{key}: {where}"
