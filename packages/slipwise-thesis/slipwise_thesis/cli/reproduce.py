# SPDX-License-Identifier: Apache-2.0
"""`slipwise reproduce`: the thesis's figures and tables, made again."""

from __future__ import annotations

import contextlib
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.options import Folder, Json, Runs, optional

if TYPE_CHECKING:
    from slipwise_thesis import ChapterResult


FILES = ("index.html", "markdown/README.md")


class WorkName(StrEnum):
    """What can be reproduced."""

    thesis = "thesis"


SUMMARY = "Make the thesis's figures and tables again."


def reproduce(
    work: Annotated[WorkName, typer.Argument(help="What to reproduce.", show_default=False)],
    output: Folder = None,
    only: Annotated[list[str] | None, optional("CHAPTER", "This chapter alone; may be given again.")] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Of the simulated drives.")] = 1,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", envvar="SLIPWISE_DATA", show_default=False, help="Folder of the real logs."
        ),
    ] = None,
    runs: Runs = Path("runs"),
    json: Json = None,
) -> int:
    """Make every figure and table of the thesis again, each with what agrees, what differs and why.

    Writes index.html and, where Matplotlib is installed, markdown/README.md with its pictures. Without a real
    log, what is made from it is left out and counted. The same seed and logs give the same files, but for
    times that are measured.

    \b
    Examples:
      slipwise reproduce thesis -o thesis
      slipwise reproduce thesis --only chapter-4 --seed 7
      SLIPWISE_DATA=logs slipwise reproduce thesis -o thesis
    """  # noqa: D301
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.run_folder import run_folder
    from slipwise.cli.tables import show_killed_runs
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.reporting.png_picture import ADVICE, can_draw
    from slipwise_thesis import reproduce as make_again
    from slipwise_thesis import write_reproduction
    from slipwise_thesis.chapters import FixturePlan, chosen_chapters
    from slipwise_thesis.extras import refuse_missing_extras

    del work
    out = Output(json)
    chapters = chosen_chapters(only or [])
    refuse_unwritable(out.written_file, *(output / name for name in FILES if output is not None))
    refuse_missing_extras()
    with progress_bar("simulating") as update:
        place = run_folder(runs, "reproduce") if output is None else contextlib.nullcontext(output)
        with place as folder:
            made = make_again(FixturePlan(seed, data), chapters=chapters, progress=update)
            files = write_reproduction(folder, made)
            missing = f"The Markdown with its pictures was left out: it needs Matplotlib ({ADVICE})."
            notes = [] if can_draw() else [missing]
            out.document(_document(made, files, seed) | {"notes": notes})
    for note in notes:
        out.line(note)
    _show(out, made, files)
    show_killed_runs(out, runs)
    return 0


def _document(made: tuple[ChapterResult, ...], files: dict[str, Path], seed: int) -> dict[str, Any]:
    from slipwise.cli.document import head

    figures = [
        {
            "chapter": chapter.key,
            "key": figure.key,
            "thesis": figure.thesis,
            "title": figure.title,
            "agrees": figure.agrees,
            "differs": figure.differs,
            "source": figure.source,
            "missing": figure.missing or None,
        }
        for chapter in made
        for figure in chapter.figures
    ]
    return head("reproduce") | {"exit_code": 0, "seed": seed, "files": files, "figures": figures}


def _show(out: Any, made: tuple[ChapterResult, ...], files: dict[str, Path]) -> None:
    from slipwise.cli.output import Column
    from slipwise.cli.tables import show_files

    columns = [
        Column("chapter", whole=True),
        Column("in the thesis", whole=True),
        Column("figure or table"),
        Column(""),
    ]
    rows = [
        (chapter.key, figure.thesis, figure.title, "missing" if figure.missing else "")
        for chapter in made
        for figure in chapter.figures
    ]
    missing = [figure.missing for chapter in made for figure in chapter.figures if figure.missing]
    caption = f"{len(rows) - len(missing)} figures and tables were made, {len(missing)} could not be."
    out.table("The thesis, made again", columns, rows, caption=caption)
    for sentence in dict.fromkeys(missing):
        out.line(sentence)
    show_files(out, files)
