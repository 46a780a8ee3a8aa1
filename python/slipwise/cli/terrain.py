# SPDX-License-Identifier: Apache-2.0
"""`slipwise terrain`: learns to name the surface from IMU and motor currents, and names it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from slipwise.cli.options import Json, optional

terrain = typer.Typer(
    name="terrain", add_completion=False, context_settings={"help_option_names": ["-h", "--help"]}
)

Tables = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG...",
        show_default=False,
        help="Tables (CSV, CSV.gz, Parquet) with `time` and wx wy wz ax ay az, or curL curR velL velR, or "
        "both; `run` where a file holds several. Rows of one run may be in two files.",
    ),
]
Classifier = Annotated[Path, typer.Argument(metavar="TERRAIN.json", show_default=False, help="As trained.")]
SHARE = 0.85  # of windows on surfaces that were not trained


@terrain.callback()
def _terrain() -> None:
    """Name the surface under the robot by its vibration and motor currents, or say that it is unknown.

    \b
    Examples:
      slipwise terrain train imu.csv currents.csv -o terrain.json
      slipwise terrain classify terrain.json today.csv -o labels.csv
    """  # noqa: D301


@terrain.command("train", short_help="Learn surfaces from logs that name them.")
def train(
    logs: Tables,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="TERRAIN.json", help="The file to write.")
    ] = Path("terrain.json"),
    window: Annotated[float, typer.Option(metavar="SECONDS", help="Length of a window, 1 to 5 s.")] = 5.0,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of the trees and of the folds.")] = 0,
    json: Json = None,
) -> int:
    """Learn surfaces from logs whose column `terrain` names them.

    Whole runs are left out in turn, so that probabilities are calibrated on drives that were not learned;
    each surface is left out once, so that the classifier knows what an unknown one looks like. Give several
    runs (drives) of each surface. The file holds plain numbers; only training needs scikit-learn.

    \b
    Examples:
      slipwise terrain train imu.csv.gz currents.csv.gz -o terrain.json
      slipwise terrain train monday.parquet tuesday.parquet -o terrain.json --window 2
      slipwise terrain train drives.csv --json - | jq .scores
    """  # noqa: D301
    from slipwise.cli.document import head
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_files, show_notes
    from slipwise.cli.terrain_tables import show_training, training_part
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.terrain import read_recordings, save_classifier
    from slipwise.terrain import train as learn

    out = Output(json)
    refuse_unwritable(output, out.written_file, inputs=logs)
    with progress_bar("reading") as update:
        recordings, notes = read_recordings(logs)
        training = learn(recordings, seconds=window, seed=seed, progress=update)
    content = training_part(training, [*notes, *training.notes])
    save_classifier(output, training.classifier, content)
    out.document(head("terrain train") | {"exit_code": 0, "files": {"classifier": output}} | content)
    show_training(out, training)
    show_notes(out, content["notes"])
    show_files(out, {"classifier": output})
    return 0


@terrain.command("classify", short_help="Name the surface of each window of a log.")
def classify(
    classifier: Classifier,
    logs: Tables,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="LABELS.csv", help="The table to write.")
    ] = Path("labels.csv"),
    unknown: Annotated[
        float,
        typer.Option(
            metavar="SHARE",
            help="Share of windows on surfaces that were not trained to call unknown; costs some of the "
            "others, as the command says. 0 always names a surface.",
        ),
    ] = SHARE,
    step: Annotated[
        float | None, optional("SECONDS", "From one window's start to the next; a window by default.")
    ] = None,
    json: Json = None,
) -> int:
    """Name the surface of each window: run, t_start, t_end, label, p_<surface>..., p_unknown.

    The p_<surface> add up to 1: they hold if the surface is one of those that were trained. p_unknown is the
    probability that it is none of them, with even prior odds. Where the log has the column
    `terrain`, the labels are compared with it.

    \b
    Examples:
      slipwise terrain classify terrain.json imu.csv currents.csv -o labels.csv
      slipwise terrain classify terrain.json drive.parquet --unknown 0.5 --step 1
      slipwise terrain classify terrain.json drive.csv --unknown 0 --json - | jq .score
    """  # noqa: D301
    from slipwise.cli.document import head
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_files, show_notes
    from slipwise.cli.terrain_tables import labels_part, show_labels
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.errors import LogError, SettingsError
    from slipwise.terrain import cut_windows, load_classifier, read_recordings, write_labels

    out = Output(json)
    refuse_unwritable(output, out.written_file, inputs=[classifier, *logs])
    learned = load_classifier(classifier)
    every = learned.cutting.seconds if step is None else step
    if not 0.05 <= every <= 3600.0:
        raise SettingsError(f"a step of {every:g} s", where="--step", advice="0.05 to 3600 s")
    with progress_bar("reading") as update:
        recordings, notes = read_recordings(logs)
        windows = cut_windows(
            recordings, learned.cutting, step=every, progress=lambda share: update("windows", share)
        )
        answer = learned.answer(windows)
        labels = learned.labels(answer, unknown)
    if not (labels != "").any():
        advice = f"windows are {learned.cutting.seconds:g} s long; gaps in the samples break them"
        raise LogError("no window to classify", where=str(logs[0]), advice=advice)
    write_labels(output, windows, answer, labels)
    content = labels_part(windows, answer, labels) | {"notes": notes}
    out.document(head("terrain classify") | {"exit_code": 0, "files": {"labels": output}} | content)
    show_labels(out, content, learned, unknown)
    show_notes(out, notes)
    show_files(out, {"labels": output})
    return 0
