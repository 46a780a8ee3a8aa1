# SPDX-License-Identifier: Apache-2.0
"""`slipwise plan`: a route through a map with a learned model, drawn with its uncertainty."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from slipwise.cli.options import GRADE_HELP, Force, Json, optional

if TYPE_CHECKING:
    from slipwise.reporting.plan_drawing import Plan


def plan(
    model: Annotated[Path, typer.Option(metavar="FILE", help="The model, as calibrate writes it.")],
    map_file: Annotated[
        Path, typer.Option("--map", metavar="FILE", help="The map: YAML with a PGM, as map_saver writes it.")
    ],
    start: Annotated[str, typer.Option("--from", metavar="X,Y,YAW", help="Where the robot stands: m, rad.")],
    goal: Annotated[str, typer.Option("--to", metavar="X,Y,YAW", help="Where it is to stand: m, rad.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="STEM", help="Files STEM.html and STEM.csv.")
    ] = Path("plan"),
    radius: Annotated[float, typer.Option(metavar="METRES", help="Of a disc that covers the robot.")] = 0.5,
    cruise: Annotated[float | None, optional("M/S", "Speed; 0.7 of the model's range by default.")] = None,
    longest: Annotated[float, typer.Option(metavar="METRES", help="Of one manoeuvre.")] = 10.0,
    grade: Annotated[str | None, optional("SLOPE,DOWNHILL", GRADE_HELP)] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Of the search round obstacles.")] = 1,
    most_cells: Annotated[
        int,
        typer.Option(
            metavar="N", min=1, max=10**9, help="Larger maps are refused; each cell takes 40 bytes."
        ),
    ] = 25_000_000,
    force: Force = False,
    json: Json = None,
) -> int:
    """Plan commands from one pose to another through a map, as the learned model says that the robot drives.

    Limits of speed and yaw rate are those that the model was learned within. A model with a bad verdict is
    refused with exit code 1 unless --force is given.

    \b
    Examples:
      slipwise plan --model model.yaml --map map.yaml --from 1,2,0 --to 8,5,1.57
      slipwise plan --model model.yaml --map map.yaml --from 1,2,0 --to 8,5,1.57 --radius 0.8 -o dock
      slipwise plan --model model.yaml --map map.yaml --from 1,2,0 --to 8,5,1.57 --grade 8,-90
    """  # noqa: D301
    from slipwise.cli.bad_verdict import say_refused
    from slipwise.cli.document import head
    from slipwise.cli.numbers import grade_of, pose_of
    from slipwise.cli.output import Output
    from slipwise.cli.tables import show_files
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.models import load_model
    from slipwise.planning import RouteOptions, RoutePlanner, TrajectoryOptions, load_map
    from slipwise.planning.grid_map import image_of
    from slipwise.reporting.plan_drawing import Plan
    from slipwise.reporting.plan_page import summary

    out = Output(json)
    learned, grid = load_model(model), load_map(map_file, most_cells=most_cells)
    files = {kind: output.with_name(f"{output.name}.{kind}") for kind in ("html", "csv")}
    refuse_unwritable(*files.values(), out.written_file, inputs=(model, map_file, image_of(map_file)))
    learned = learned.of_input("command")
    if not learned.verdict.good and not force:
        say_refused(out, learned, "plan")
        return 1
    begin, end = pose_of(start, "--from"), pose_of(goal, "--to")
    planner = RoutePlanner(
        learned,
        grid,
        options=TrajectoryOptions(cruise=cruise, longest=longest),
        search=RouteOptions(radius=radius, seed=seed),
        ground=grade_of(grade),
    )
    drawn = Plan(planner.route(begin, end), grid, radius, begin, end, f"{model.name} on {map_file.name}")
    _write(files, drawn)
    out.document(head("plan") | {"exit_code": 0, "files": files} | _figures(drawn))
    for sentence in summary(drawn):
        out.line(sentence)
    show_files(out, files)
    return 0


def _write(files: dict[str, Path], drawn: Plan) -> None:
    from slipwise.files import write_text_whole
    from slipwise.reporting.plan_page import plan_page

    write_text_whole(files["html"], plan_page(drawn))
    trajectory = drawn.route.trajectory
    names = ",".join(("t", *(f"cmd_{name}" for name in trajectory.columns)))
    rows = (",".join(f"{value:.6f}" for value in row) for row in trajectory.commands.tolist())
    write_text_whole(files["csv"], "\n".join((names, *rows)) + "\n")


def _figures(drawn: Plan) -> dict[str, Any]:
    route = drawn.route
    return {
        "duration": route.trajectory.duration,
        "legs": route.legs,
        "clearance": route.clearance,
        "end": route.predicted[-1].tolist(),
        "end_covariance": route.covariance[-1].tolist(),
        "commands": route.trajectory.commands.tolist(),
    }
