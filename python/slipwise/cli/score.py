# SPDX-License-Identifier: Apache-2.0
"""`slipwise score`: how well any method's prediction file says where the robot of a log went."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import Changes, Input, Json, Logs, SettingsFile, chosen_settings, takes_log_options

if TYPE_CHECKING:
    from slipwise.logs import LogOptions


@takes_log_options
def score(
    predictions: Annotated[
        Path, typer.Argument(metavar="PREDICTIONS", show_default=False, help="A prediction file (CSV).")
    ],
    logs: Logs,
    log_options: LogOptions,
    input_name: Input = None,
    settings: SettingsFile = None,
    changes: Changes = None,
    json: Json = None,
) -> int:
    """Score a prediction file, of whatever method, on the log that it is of, by the rules of `evaluate`.

    The second half of the windows counts, and each of them must be predicted. Errors are shown relative to
    the kinematic baseline, which is computed here; NIS and coverage where the file has covariances. The
    windows to predict: `slipwise evaluate LOG --methods none --predictions windows.csv`.

    \b
    Examples:
      slipwise score predictions.csv log.parquet
      slipwise score predictions.csv log.parquet --input wheel --json scores.json
    """  # noqa: D301
    from slipwise.cli.document import evaluation_part, head, log_part
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_left_out, show_notes, show_scores
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.evaluation import score_predictions
    from slipwise.logs import open_log

    out = Output(json)
    chosen = chosen_settings(settings, changes)
    refuse_unwritable(out.written_file, inputs=(predictions, *logs, *log_options.files, settings))
    with progress_bar("reading") as update:
        log = open_log(*logs, options=log_options)
        update("scoring", 0.5)
        scored = score_predictions(predictions, log, input=input_name, settings=chosen)
    out.document(head("score") | {"exit_code": 0} | evaluation_part(scored) | log_part(log, scored.left_out))
    show_notes(out, scored.notes)
    show_left_out(out, scored.left_out)
    show_scores(out, scored)
    return 0
