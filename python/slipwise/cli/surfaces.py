# SPDX-License-Identifier: Apache-2.0
"""`slipwise surfaces`: the surfaces that a model file remembers, listed, renamed, joined with another's."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.options import Json, ModelFile

if TYPE_CHECKING:
    from slipwise.models import Model

surfaces = typer.Typer(
    name="surfaces", add_completion=False, context_settings={"help_option_names": ["-h", "--help"]}
)

Second = Annotated[
    Path, typer.Argument(metavar="OTHER", show_default=False, help="Another one, of the same robot.")
]
Output = Annotated[
    Path, typer.Option("-o", "--output", metavar="MODEL.yaml", show_default=False, help="The file to write.")
]


@surfaces.callback()
def _surfaces() -> None:
    """Look at the surfaces that a model file remembers, rename them, and join those of two files.

    \b
    Examples:
      slipwise surfaces list model.yaml
      slipwise surfaces merge monday.yaml tuesday.yaml -o both.yaml
    """  # noqa: D301


@surfaces.command("list", short_help="Show the surfaces of a model file.")
def list_surfaces(model: ModelFile, json: Json = None) -> int:
    """Show the surfaces of a model file: hours, visits, date, speeds.

    \b
    Examples:
      slipwise surfaces list model.yaml
      slipwise surfaces list model.yaml --json - | jq '.surfaces[].name'
    """  # noqa: D301
    from slipwise.cli.output import Output as Printer
    from slipwise.cli.tables import show_surfaces
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.models import load_model

    out = Printer(json)
    refuse_unwritable(out.written_file, inputs=[model])
    learned = load_model(model)
    out.document(_document("surfaces list", learned))
    show_surfaces(out, learned.content.surfaces)
    return 0


@surfaces.command("rename", short_help="Give a surface another name.")
def rename(
    model: ModelFile,
    old: Annotated[str, typer.Argument(metavar="OLD", show_default=False, help="Its name now.")],
    new: Annotated[str, typer.Argument(metavar="NEW", show_default=False, help="Its new name.")],
    output: Output,
    json: Json = None,
) -> int:
    """Give a surface another name, such as the one that labels have for it.

    \b
    Examples:
      slipwise surfaces rename model.yaml "surface 1" sand -o named.yaml
    """  # noqa: D301
    from slipwise.cli.output import Output as Printer
    from slipwise.cli.tables import show_files, show_surfaces
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.models import load_model
    from slipwise.models.on_surface import renamed

    out = Printer(json)
    refuse_unwritable(output, out.written_file, inputs=[model])
    learned = renamed(load_model(model), old, new)
    files = {"model": learned.save(output)}
    out.document(_document("surfaces rename", learned) | {"files": files})
    show_surfaces(out, learned.content.surfaces)
    show_files(out, files)
    return 0


@surfaces.command("merge", short_help="Join the surfaces of two model files of one robot.")
def merge(model: ModelFile, second: Second, output: Output, json: Json = None) -> int:
    """Join the surfaces of two model files of one robot, input and basis.

    Surfaces that cannot be distinguished become one, and both memories count. Others keep their names; one
    whose name is taken gets a number. The robot's lags and delays are those of the first file.

    \b
    Examples:
      slipwise surfaces merge monday.yaml tuesday.yaml -o both.yaml
    """  # noqa: D301
    from dataclasses import asdict

    from slipwise.calibration.merge_surfaces import merge_surfaces
    from slipwise.calibration.same_log import logs_of_both, twice_in_both
    from slipwise.cli.model_names import named_models
    from slipwise.cli.output import Column
    from slipwise.cli.output import Output as Printer
    from slipwise.cli.tables import show_files, show_surfaces
    from slipwise.cli.writable import refuse_unwritable

    out = Printer(json)
    refuse_unwritable(output, out.written_file, inputs=[model, second])
    one, other = named_models([model, second]).values()
    learned, done = merge_surfaces(one, other)
    both = logs_of_both(one, other)
    files = {"model": learned.save(output)}
    out.document(
        _document("surfaces merge", learned)
        | {"files": files, "merged": [asdict(each) for each in done], "logs_of_both": both}
    )
    rows = [
        (each.name, each.became or "dropped", "not distinguished from it" if each.merged else "")
        for each in done
    ]
    if both:
        out.line(twice_in_both(both))
    out.table(f"Surfaces of {second.name}", (Column("name"), Column("is now"), Column("")), rows)
    show_surfaces(out, learned.content.surfaces)
    show_files(out, files)
    return 0


def _document(command: str, learned: Model) -> dict[str, Any]:
    from slipwise.cli.document import head, surfaces_part

    return head(command) | {"exit_code": 0, "surfaces": surfaces_part(learned)}
