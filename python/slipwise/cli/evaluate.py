# SPDX-License-Identifier: Apache-2.0
"""`slipwise evaluate`: methods compared on what they had not seen."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import (
    Basis,
    Changes,
    Input,
    Json,
    Labels,
    Logs,
    Report,
    Runs,
    SettingsFile,
    chosen_settings,
    optional,
    takes_log_options,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from slipwise.calibration import Calibration, Settings, Verdict
    from slipwise.cli.output import Output
    from slipwise.evaluation import Evaluation
    from slipwise.evaluation.evaluate import EvaluationOptions
    from slipwise.logs import Log, LogOptions


@takes_log_options
def evaluate(
    logs: Logs,
    log_options: LogOptions,
    model: Annotated[
        list[Path] | None,
        optional("MODEL.yaml", "Judge this model file too, as it is; give it again for several."),
    ] = None,
    input_name: Input = None,
    horizons: Annotated[
        str, typer.Option(metavar="SECONDS", help="How far ahead, separated by commas.")
    ] = "1,2,5",
    embargo: Annotated[
        float | None,
        optional(
            "SECONDS",
            "Nothing measured within so many seconds before a prediction is learned for it; 0: the newest "
            "parameters, as a live node has them. Default: the horizon.",
        ),
    ] = None,
    methods: Annotated[
        str | None,
        optional(
            "NAMES",
            "vendor, batch, model, auto, bases, single estimators (gradient-descent, ekf-thesis, iekf, "
            "delayed-state), slip-ratio-ekf or slip-ratio-smo, surfaces (surface-least-squares, "
            "surface-gaussian-process, surface-bayesian), separated by commas; "
            "`none` always is. Default: all but estimators, slip ratios and surfaces. Those and "
            "batch come with the package slipwise-thesis.",
        ),
    ] = None,
    vendor_wheel_separation_multiplier: Annotated[
        float | None, optional("X", "wheel_separation_multiplier of the method `vendor`.")
    ] = None,
    predictions: Annotated[
        Path | None, optional("FILE.csv", "Write every prediction with its covariance.")
    ] = None,
    memory: Annotated[
        bool,
        typer.Option(
            "--memory",
            help="The logs are drives of one robot in the order of time: remember surfaces from one to the "
            "next, and recall them. --model gives the surfaces of earlier drives.",
        ),
    ] = False,
    surface: Labels = None,
    basis: Basis = None,
    settings: SettingsFile = None,
    changes: Changes = None,
    report: Report = None,
    runs: Runs = Path("runs"),
    json: Json = None,
) -> int:
    """Compare methods on logs: each window is predicted from what was known before it.

    The exit code is 1 where what is judged (the first model given, whatever --methods says, else `auto`, else
    the first that learns) does not beat doing nothing at the longest horizon. Settings and result go into a
    new folder below `runs`.

    \b
    Examples:
      slipwise evaluate drive.mcap
      slipwise evaluate drive.mcap --model model.yaml --horizons 2,5
      slipwise evaluate drive.mcap --model monday.yaml --model tuesday.yaml
      slipwise evaluate drive.csv --input wheel --methods none,edd-2,odd-even-10,auto
      slipwise evaluate drive.csv --input wheel --methods icr-3,slip-ratio-ekf,slip-ratio-smo,auto
      slipwise evaluate drive.csv --methods gradient-descent,ekf-thesis,iekf,delayed-state --basis drive-5
      slipwise evaluate drive.csv --methods surface-least-squares,surface-bayesian,auto
      slipwise evaluate drive.csv --vendor-wheel-separation-multiplier 1.875 --predictions predictions.csv
      slipwise evaluate --memory sand.csv asphalt.csv sand2.csv --predictions predictions.csv
      slipwise evaluate --memory --model monday.yaml tuesday.csv --surface sand
      slipwise evaluate drive.csv --json - | jq '.scores[] | {method, horizon, position: .position.mean}'
    """  # noqa: D301
    from slipwise.cli.evaluation_verdict import verdict_on
    from slipwise.cli.memory_options import label_files, refuse_labels, sequence_options
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.run_folder import run_folder, write_settings
    from slipwise.cli.tables import show_killed_runs
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.evaluation import evaluate as judge_methods
    from slipwise.evaluation import write_predictions
    from slipwise.logs import open_log

    out = Output(json)
    chosen = chosen_settings(settings, changes, basis)
    options, models = (
        _options(horizons, embargo, methods, vendor_wheel_separation_multiplier, model or []),
        model or [],
    )
    read = (*logs, *log_options.files, *models, settings, *label_files(surface))
    refuse_unwritable(predictions, report, out.written_file, inputs=read)
    if memory:
        from slipwise.cli.evaluate_memory import MemoryQuestion, evaluate_memory

        begin = sequence_options(models, surface, logs)
        asked = MemoryQuestion(logs, log_options, input_name, options, begin, predictions, report)
        return evaluate_memory(out, asked, chosen, runs)
    refuse_labels(surface)
    with progress_bar("reading") as update:
        log = open_log(*logs, options=log_options)
        with run_folder(runs, "evaluate") as folder:
            evaluation = judge_methods(
                log,
                input=input_name,
                settings=chosen,
                options=options,
                progress=lambda name, fraction: update(f"method {name}", fraction),
            )
            files = {"settings": write_settings(folder, chosen)}
            if predictions is not None:
                write_predictions(predictions, evaluation)
                files["predictions"] = predictions
            calibration = _learned(log, evaluation, chosen)
            if report is not None:
                update("writing the report", 1.0)
                _write_report(report, log, evaluation, calibration)
                files["report"] = report
            judged = next(iter(options.models.values()), None)
            verdict = verdict_on(evaluation, judged or calibration)
            _write_result(out, folder, (log, evaluation, verdict), files)
    steps = _next_step(evaluation, verdict, model or [])
    _show(out, evaluation, verdict, files | {"run folder": folder}, steps)
    show_killed_runs(out, runs)
    return 0 if verdict is None or verdict.good else 1


def _options(
    horizons: str,
    embargo: float | None,
    methods: str | None,
    multiplier: float | None,
    models: Sequence[Path],
) -> EvaluationOptions:
    from slipwise.cli.model_names import named_models
    from slipwise.errors import SettingsError
    from slipwise.evaluation import EvaluationOptions

    try:
        seconds = tuple(float(part) for part in horizons.split(",") if part.strip())
    except ValueError:
        raise SettingsError(
            f"'{horizons}' is not a list of seconds", where="--horizons", advice="such as 1,2,5"
        ) from None
    names = None
    if methods is not None:
        names = tuple(dict.fromkeys(["none", *(part.strip() for part in methods.split(",") if part.strip())]))
    return EvaluationOptions(seconds, names, multiplier, named_models(models), embargo=embargo)


def _next_step(evaluation: Evaluation, verdict: Verdict | None, models: Sequence[Path]) -> tuple[str, ...]:
    """What to do with a model file that was judged on a log it had not learned from."""
    from slipwise.calibration.next_step import after_checking, compare_command
    from slipwise.evaluation import simpler_method

    if verdict is None or not models:
        return ()
    if verdict.good and simpler_method(evaluation, evaluation.models[0]) is not None:
        return ("Next: calibrate from this log, then compare:", f"  {compare_command(models[0])}")
    causal = evaluation.score(evaluation.models[0], max(evaluation.horizons)).causal
    return after_checking(verdict, models[0]) if causal else ()


def _show(
    out: Output,
    evaluation: Evaluation,
    verdict: Verdict | None,
    files: dict[str, Path],
    steps: Sequence[str],
) -> None:
    from slipwise.cli.compare import comparison_sentences
    from slipwise.cli.tables import show_files, show_left_out, show_notes, show_scores, show_verdict

    show_notes(out, evaluation.notes)
    show_left_out(out, evaluation.left_out)
    show_scores(out, evaluation)
    if len(evaluation.models) > 1:
        for sentence in comparison_sentences(evaluation):
            out.line(sentence)
    if verdict is None:
        out.line("No method that learns was asked for, so there is no verdict.")
    else:
        show_verdict(out, verdict, steps)
    show_files(out, files)


def _write_result(
    out: Output, folder: Path, result: tuple[Log, Evaluation, Verdict | None], files: dict[str, Path]
) -> None:
    from slipwise.cli.document import evaluation_part, head, log_part, verdict_part
    from slipwise.cli.output import to_json
    from slipwise.files import write_text_whole

    log, evaluation, verdict = result
    document = (
        head("evaluate")
        | {
            "exit_code": 0 if verdict is None or verdict.good else 1,
            "verdict": verdict_part(verdict),
            "files": files,
        }
        | evaluation_part(evaluation)
        | log_part(log, evaluation.left_out)
    )
    write_text_whole(folder / "result.json", to_json(document))
    out.document(document)


def _learned(log: Log, evaluation: Evaluation, settings: Settings) -> Calibration | None:
    """Learn what the judged method learns, for its parameters; None where no method learns."""
    from slipwise import plugins
    from slipwise.calibration import calibrate
    from slipwise.calibration.settings import AVERAGE
    from slipwise.cli.evaluation_verdict import judged_method

    method = judged_method(evaluation.methods, evaluation.models)
    if method is None:
        return None
    if method in plugins.added(plugins.ESTIMATORS):
        settings = settings.model_copy(update={"estimator": method})
    elif method not in evaluation.models:
        settings = settings.model_copy(update={"basis": method, "estimator": AVERAGE})
    return calibrate(log, input=evaluation.input, settings=settings)


def _write_report(path: Path, log: Log, evaluation: Evaluation, calibration: Calibration | None) -> None:
    from slipwise.cli.command_line import command_line
    from slipwise.errors import SettingsError
    from slipwise.reporting import write_report

    if calibration is None:
        raise SettingsError("no method learns", where="--report", advice="add auto to --methods")
    title = ", ".join(run.name for run in log.runs[:3])
    write_report(
        path, log=log, calibration=calibration, evaluation=evaluation, title=title, command=command_line()
    )
