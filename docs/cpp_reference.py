# SPDX-License-Identifier: Apache-2.0
"""Makes the site's C++ reference from the installed headers: what is public in them, with their comments."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
HEADERS = ROOT / "cpp/include/slipwise"
#: Folders that have a page, in the order of the menu, and what they are for.
FOLDERS = {
    "online": "Learning while the robot drives: start at `MotionLearner`.",
    "segment": "Predicting one path, with its derivatives and its covariance.",
    "motion": "What a model is: slip, actuator and noise.",
    "slip": "Terms, and bases made of them.",
    "actuator": "Delay, lags and limits between a command and the motion.",
    "rollout": "Driving many command sequences through a model at once: start at `rollout_batch`.",
    "planning": "Manoeuvres, routes, control and lattices through a model.",
    "vehicle": "Wheel speeds and steering angles as a twist of the body.",
    "dynamics": "A user's own dynamics: derive from `DynamicsModel`, learn with `DynamicsFilter`.",
    "lie": "Poses, tangents and their Jacobians.",
}
TYPE = re.compile(r"^(?:template\s*<[^{]*>\s*)?(?:class|struct|enum(?: class)?|union)\s+(\w+)[^;(]*$")
LABEL = re.compile(r"^(public|private|protected):")
INITIALISERS = re.compile(r"(\)(?:\s*noexcept)?)\s*:\s[^:].*$", re.DOTALL)
CLOSE = {"{": "}", "(": ")"}


def end_of(text: str, at: int) -> int:
    """Return the index behind the bracket that closes the one at `at`; brackets in comments do not count."""
    opening, closing, depth = text[at], CLOSE[text[at]], 0
    while at < len(text):
        if text.startswith("//", at):
            at = text.find("\n", at)
            if at < 0:
                break
        elif text[at] == '"':
            at = re.compile(r'"(?:\\.|[^"\\])*"').match(text, at).end() - 1  # type: ignore[union-attr]
        elif text[at] == opening:
            depth += 1
        elif text[at] == closing:
            depth -= 1
            if depth == 0:
                return at + 1
        at += 1
    raise ValueError(f"a {opening} is not closed: {text[:80]!r}")


def one(text: str, at: int) -> tuple[str, str, int]:
    """Return a declaration's head and body (empty: it has none that is shown), and where it ends.

    A body is that of a type; those of functions are left out, initialisers of values stay in the head.
    """
    head, start = "", at
    while at < len(text):
        character = text[at]
        if text.startswith("//", at):
            at = text.find("\n", at)
            continue
        if character == "(":
            at = end_of(text, at)
        elif character == ";":
            return text[start:at] + ";", "", at + 1
        elif character == ":" and LABEL.match(text[start : at + 1]):
            return text[start : at + 1], "", at + 1
        elif character == "{":
            head, end = text[start:at], end_of(text, at)
            follows = text[end:].lstrip()[:1]
            if TYPE.match(head.strip()):
                return head.strip(), text[at + 1 : end - 1], text.index(";", end) + 1
            if head.strip().startswith("namespace"):
                return "", "", end
            if follows not in (";", ",", "."):
                return INITIALISERS.sub(r"\1", head).strip() + ";", "", end
            at = end
        else:
            at += 1
    return text[start:].strip(), "", len(text)


def declarations(text: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield the comment above each declaration, its head, its body, and the comment behind it."""
    at = 0
    while True:
        comment: list[str] = []
        while (line := re.compile(r"\s*(//[^\n]*)\n").match(text, at)) is not None:
            gap = "\n" in text[at : line.start(1)]  # what stands above an empty line is about something else
            comment = [*([] if gap else comment), line[1]]
            at = line.end()
        at += len(text[at:]) - len(text[at:].lstrip())
        if at >= len(text):
            return
        head, body, at = one(text, at)
        behind = re.compile(r"[ \t]*(//[^\n]*(?:\n[ \t]*///<[^\n]*)*)").match(text, at)
        after = "" if behind is None else behind[1]
        at = at if behind is None else behind.end()
        yield "\n".join(comment), head, body, after


def shown(text: str, depth: int = 0) -> Iterator[tuple[str, str]]:
    """Yield (name of the type or nothing, text) of what is public in a namespace or a type."""
    public = True
    for comment, head, body, after in declarations(text):
        label = LABEL.match(head)
        if label is not None:
            public = label[1] == "public"
        if label is not None or not public or not head:
            continue
        found = TYPE.match(head)
        lines = [*comment.splitlines(), *head.splitlines()]
        if found is not None and body:
            lines[-1] += " {"
            inner = [body] if head.startswith("enum") else [part for _, part in members(head, body, depth)]
            lines += [line for part in inner for line in part.strip("\n").splitlines()] + ["};"]
        if after:
            lines[-1] += f"  {after}"
        yield (
            found[1] if found is not None and body else "",
            "\n".join(line if line.startswith("  ") or not depth else f"  {line}" for line in lines),
        )


def members(head: str, body: str, depth: int) -> Iterator[tuple[str, str]]:
    """Yield what is public in a class, which starts private, or in a struct."""
    private = re.search(r"\bclass\b", head) is not None
    return shown(("private:\n" if private else "") + body, depth + 1)


def page(folder: str) -> str:
    """Return the page of one folder of headers."""
    lines = [f"# slipwise/{folder}", "", FOLDERS[folder], ""]
    lines += [
        "Made from the headers; their comments have units and errors. All is in the namespace `slipwise`.",
        "",
    ]
    for header in sorted((HEADERS / folder).glob("*.hpp")):
        text = header.read_text(encoding="utf-8")
        sentence = " ".join(re.findall(r"^// (.*)$", text.partition("#pragma once")[0], re.MULTILINE)[1:])
        start = re.search(r"^namespace slipwise(?:::\w+)? \{", text, re.MULTILINE)
        inside = "" if start is None else text[start.end() : end_of(text, start.end() - 1) - 1]
        inside = re.sub(r"^#.*$", "", inside, flags=re.MULTILINE)
        lines += [f"## {header.name}", "", sentence, "", f"`#include <slipwise/{folder}/{header.name}>`", ""]
        loose: list[str] = []
        for name, part in shown(inside):
            if not name:
                loose.append(part)
                continue
            lines += [f"### {name}", "", "```cpp", part, "```", ""]
        if loose:
            lines += ["```cpp", *loose, "```", ""]
    return "\n".join(lines)


def on_files(files: Any, config: Any) -> Any:
    """Add a page for each folder."""
    from mkdocs.structure.files import File

    for folder in FOLDERS:
        files.append(File.generated(config, f"cpp/{folder}.md", content=page(folder)))
    return files
