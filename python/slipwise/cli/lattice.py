# SPDX-License-Identifier: Apache-2.0
"""`slipwise lattice`: primitives for Nav2's lattice planner, and what curvature the robot really holds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import GRADE_HELP, Force, Json, ModelFile, optional

if TYPE_CHECKING:
    from slipwise.planning import CurvatureMap


def lattice(
    model: ModelFile,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FOLDER", help="The folder to put the files into.")
    ] = Path("lattice"),
    speed: Annotated[float, typer.Option(metavar="M/S", help="The same along all primitives.")] = 0.5,
    grid: Annotated[float, typer.Option(metavar="METRES", help="Between grid points; the costmap's.")] = 0.05,
    headings: Annotated[int, typer.Option(metavar="N", help="A multiple of 8.")] = 16,
    turns: Annotated[int, typer.Option(metavar="N", help="Headings a primitive turns by at most.")] = 3,
    longest: Annotated[float, typer.Option(metavar="METRES", help="Of one primitive.")] = 6.0,
    grade: Annotated[str | None, optional("SLOPE,DOWNHILL", GRADE_HELP)] = None,
    curvature: Annotated[float | None, optional("1/M", "Largest of commands; by the model's range.")] = None,
    force: Force = False,
    json: Json = None,
) -> int:
    """Write state-lattice primitives that the robot can really drive, for Nav2's Smac lattice planner.

    lattice.json is what `lattice_filepath` names: every primitive has the slip that the model learned, at one
    speed, on a slope each heading its own. curvature.csv says what curvature the robot holds at what speed
    and command on level ground.
    A model with a bad verdict is refused with exit code 1 unless --force is given.

    \b
    Examples:
      slipwise lattice model.yaml -o lattice/
      slipwise lattice model.yaml -o lattice/ --speed 0.8 --grid 0.1 --longest 10
      slipwise lattice model.yaml --headings 24 --curvature 0.8
      slipwise lattice model.yaml --grade 8,-90
    """  # noqa: D301
    from dataclasses import replace
    from json import loads

    from slipwise.cli.bad_verdict import say_refused
    from slipwise.cli.document import head
    from slipwise.cli.numbers import grade_of
    from slipwise.cli.output import Output
    from slipwise.cli.tables import show_files
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.models import load_model
    from slipwise.planning import LatticeOptions, curvature_map, limits_of, write_lattice

    out = Output(json)
    files = {"lattice": output / "lattice.json", "curvature": output / "curvature.csv"}
    refuse_unwritable(*files.values(), out.written_file, inputs=[model])
    learned = load_model(model).of_input("command")
    if not learned.content.verdict.good and not force:
        say_refused(out, learned, "lattice")
        return 1
    options = LatticeOptions(speed=speed, grid=grid, headings=headings, turns=turns, longest=longest)
    limits = limits_of(learned)
    limits = limits if curvature is None else replace(limits, curvature=curvature)
    held = curvature_map(learned, limits=limits)
    _write_table(files["curvature"], held)
    written = write_lattice(files["lattice"], learned, options=options, limits=limits, grade=grade_of(grade))
    text = written.read_text(encoding="utf-8")
    metadata = loads(text)["lattice_metadata"]
    content = {"exit_code": 0, "files": files, "lattice_metadata": metadata}
    out.document(head("lattice") | content)
    out.line(f"{metadata['number_of_trajectories']} primitives over {headings} headings at {speed:g} m/s.")
    out.line(f"Slip leaves a turning radius of {metadata['turning_radius']:.2f} m at this speed.")
    show_files(out, files)
    return 0


def _write_table(path: Path, held: CurvatureMap) -> None:
    """Write the curvature map; commands beyond the limits are left out."""
    import numpy as np

    from slipwise.files import write_text_whole

    rows = ["speed,commanded_curvature,held_curvature,achieved_speed,sideslip"]
    for i, j in np.argwhere(np.isfinite(held.held)).tolist():
        values = (
            held.speed[i],
            held.commanded[j],
            held.held[i, j],
            held.achieved_speed[i, j],
            held.sideslip[i, j],
        )
        rows.append(",".join(f"{value:.6f}" for value in values))
    write_text_whole(path, "\n".join(rows) + "\n")
