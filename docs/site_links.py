# SPDX-License-Identifier: Apache-2.0
"""Puts the pages at the root into the site, and turns links to files that are not in it into text."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
#: Pages at the root, and what they are called in the site.
ROOT_PAGES = {
    "README.md": "index.md",
    "ARCHITECTURE.md": "ARCHITECTURE.md",
    "CONTRIBUTING.md": "CONTRIBUTING.md",
    "STYLE.md": "STYLE.md",
    "CHANGELOG.md": "CHANGELOG.md",
}
LINK = re.compile(r"(?P<image>!?)\[(?P<label>(?:[^\[\]]|\[[^\]]*\])*)\]\((?P<target>[^)\s]+)\)")
FENCE = re.compile(r"^```.*?^```$", re.DOTALL | re.MULTILINE)


def in_site(path: str) -> str | None:
    """Return where the site holds a file of the repository, None where it does not."""
    if path in ROOT_PAGES:
        return ROOT_PAGES[path]
    if path.startswith("docs/") and Path(path).suffix in (".md", ".png") and (ROOT / path).is_file():
        return path.removeprefix("docs/")
    return None


def in_repository(page: str) -> str:
    """Return the file of the repository that a page of the site is made from."""
    names = {site: own for own, site in ROOT_PAGES.items()}
    return names.get(page, f"docs/{page}")


def for_site(text: str, page: str) -> str:
    """Return the text of a page with links that work in the site; what is not in it is named instead.

    Args:
        text: of the page, in Markdown.
        page: its path in the site, as in "derivations/model.md".
    """
    folder = Path(in_repository(page)).parent

    def link(match: re.Match[str]) -> str:
        target, _, anchor = match["target"].partition("#")
        if not target or "://" in target or target.startswith("mailto:"):
            return match[0]
        path = os.path.normpath(folder / target)
        found = in_site(path)
        if found is None:
            label = match["label"]
            return label if path in label else f"{label} (`{path}`)"
        relative = os.path.relpath(found, Path(page).parent)
        return f"{match['image']}[{match['label']}]({relative}{'#' + anchor if anchor else ''})"

    parts, end = [], 0
    for fence in FENCE.finditer(text):
        parts += [LINK.sub(link, text[end : fence.start()]), fence[0]]
        end = fence.end()
    return "".join([*parts, LINK.sub(link, text[end:])])


def on_files(files: Any, config: Any) -> Any:
    """Add the pages at the root."""
    from mkdocs.structure.files import File

    for own, site in ROOT_PAGES.items():
        files.append(File.generated(config, site, abs_src_path=str(ROOT / own)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Rewrite the links of one page."""
    return for_site(markdown, page.file.src_uri)
