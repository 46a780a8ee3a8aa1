# SPDX-License-Identifier: Apache-2.0
"""Links between documents lead somewhere."""

import re
import unicodedata
from pathlib import Path

import pytest
from python.tests.docs.pages import PAGES, ROOT, name_of, prose

LINK = re.compile(r"\]\(([^)\s]+)\)")


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as code hosts make them."""
    found = set()
    for heading in re.findall(r"^#+ (.*)$", prose(page), re.MULTILINE):
        kept = [c for c in heading.lower() if c in " -_" or unicodedata.category(c)[0] in "LN"]
        found.add("".join(kept).replace(" ", "-"))
    return found


def test_links_of_a_page_resolve(subtests: pytest.Subtests) -> None:
    for page in PAGES:
        with subtests.test(page=page):
            broken = []
            for link in LINK.findall(prose(page)):
                if link.startswith(("http://", "https://", "mailto:")):
                    continue
                path, _, anchor = link.partition("#")
                target = (page.parent / path).resolve() if path else page
                if not target.exists() or (
                    anchor and target.suffix == ".md" and anchor not in anchors(target)
                ):
                    broken.append(link)
            assert not broken


def test_every_page_is_reached_from_the_readme() -> None:
    reached, waiting = set(), [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        if page in reached or page.suffix != ".md":
            continue
        reached.add(page)
        links = [link.partition("#")[0] for link in LINK.findall(prose(page)) if "://" not in link]
        waiting += [(page.parent / link).resolve() for link in links if link]
    assert set(PAGES) == reached


def test_pages_that_sources_name_exist() -> None:
    named = re.compile(r"\b(?:docs/|(?=derivations/))([\w/-]+\.md)")
    tops = ("cpp", "python/slipwise", "python/bindings", "packages", "benchmarks", "docs")
    files = [path for top in tops for path in (ROOT / top).rglob("*")]
    sources = [path for path in files if path.suffix in (".py", ".hpp", ".cpp", ".cu", ".yaml")]
    gone = {
        f"{name_of(path)}: {page}"
        for path in sources
        for page in named.findall(path.read_text(encoding="utf-8"))
        if not (ROOT / "docs" / page).exists()
    }
    assert len(sources) > 500
    assert not gone
