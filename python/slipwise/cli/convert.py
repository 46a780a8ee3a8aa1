# SPDX-License-Identifier: Apache-2.0
"""`slipwise convert`: a log as a tidy table or as MCAP; a model file of an older version as one of this."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slipwise.cli.options import Json, Logs, SettingsFile, optional, takes_log_options
from slipwise.errors import ModelError, OutputError, SettingsError

if TYPE_CHECKING:
    from slipwise.cli.output import Output
    from slipwise.logs import Log, LogOptions

_MODEL_ENDINGS = (".yaml", ".yml")


@takes_log_options
def convert(
    logs: Logs,
    log_options: LogOptions,
    output: Annotated[
        Path | None,
        optional("FILE", "The new log (.csv, .csv.gz, .parquet, .mcap), or model (.yaml).", "-o", "--output"),
    ] = None,
    anonymise: Annotated[
        bool, typer.Option("--anonymise", help="Take out place, time and names; writes a data card, too.")
    ] = False,
    card: Annotated[
        bool, typer.Option("--card", help="Write schema, data card and windows to predict beside a .parquet.")
    ] = False,
    keep: Annotated[str | None, optional("NAMES", "Further columns that --anonymise carries along.")] = None,
    licence: Annotated[str | None, optional("NAME", "Licence on the card, such as CC-BY-4.0.")] = None,
    robot: Annotated[str | None, optional("TEXT", "Vehicle on the card: make, drive, sizes, mass.")] = None,
    sensors: Annotated[str | None, optional("TEXT", "On the card: what measured poses and inputs.")] = None,
    settings: SettingsFile = None,
    json: Json = None,
) -> int:
    """Write one or several logs as one tidy table, or as MCAP; says what was guessed and what was left out.

    With --anonymise or --card it is a data set to share: a schema file, a data card and the windows to
    predict go beside a Parquet table.

    A model file of slipwise 0.1 is written under the names of this version, beside it where no -o is given.

    \b
    Examples:
      slipwise convert drive.mcap -o drive.csv
      slipwise convert monday.bag tuesday.db3 -o both.parquet --pose-topic /rtk/odom
      slipwise convert wheels.csv -o drive.mcap --wheel-radius 0.165 --wheel-separation 0.555
      slipwise convert run.mcap -o run.csv --poses lidar_tum.txt --pose-clock-offset auto
      slipwise convert run.mcap -o shared.parquet --anonymise --licence CC-BY-4.0 --robot "Husky A200"
      slipwise convert model.yaml -o model-0.2.yaml
    """  # noqa: D301
    from slipwise.calibration.same_log import refuse_same_log
    from slipwise.cli.document import head, log_part
    from slipwise.cli.output import Output
    from slipwise.cli.progress import progress_bar
    from slipwise.cli.tables import show_files, show_left_out, show_notes
    from slipwise.cli.writable import refuse_unknown_log_format, refuse_unwritable
    from slipwise.logs import open_log, save_log

    out = Output(json)
    if logs[0].suffix in _MODEL_ENDINGS:
        return _convert_model(logs, output, out)
    if output is None:
        raise OutputError("no output file given", advice="give -o FILE, such as -o drive.csv")
    refuse_unknown_log_format(output)
    request = ShareRequest(anonymise, card or anonymise, keep, licence, robot, sensors)
    files = {"log": output} | request.files(output)
    refuse_unwritable(*files.values(), out.written_file, inputs=(*logs, *log_options.files, settings))
    with progress_bar("reading") as update:
        read = open_log(*logs, options=log_options)
        refuse_same_log(read)
        log = request.without_names(read)
        update("writing", 0.2)
        left_out = log.left_out + save_log(log, output)
        request.write_beside(output, update)
    out.document(head("convert") | {"exit_code": 0, "files": files} | log_part(log, left_out))
    show_notes(out, log.notes)
    show_left_out(out, left_out)
    show_files(out, files)
    return 0


def _convert_model(models: list[Path], output: Path | None, out: Output) -> int:
    """Write one model file under the names of this version."""
    from slipwise.cli.document import head
    from slipwise.cli.tables import show_files
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.models import SCHEMA_VERSION, load_model

    source, *more = models
    if more:
        raise ModelError("one model at a time", where=str(more[0]), advice="run convert once for each file")
    target = output or source.with_name(f"{source.stem}-schema{SCHEMA_VERSION}.yaml")
    refuse_unwritable(target, out.written_file, inputs=(source,))
    model = load_model(source)
    model.save(target)
    out.document(head("convert") | {"exit_code": 0, "files": {"model": target}})
    show_files(out, {"model": target})
    return 0


@dataclass(frozen=True)
class ShareRequest:
    """Options of `convert` for a data set to share.

    Raises:
        SettingsError: an option is given that has no effect without another.
    """

    anonymise: bool
    card: bool
    keep: str | None
    licence: str | None
    robot: str | None
    sensors: str | None

    def __post_init__(self) -> None:
        if self.keep is not None and not self.anonymise:
            raise SettingsError("no columns are removed", where="--keep", advice="it goes with --anonymise")
        for name in ("licence", "robot", "sensors"):
            value = getattr(self, name)
            if value is not None and not self.card:
                raise SettingsError("no card is written", where=f"--{name}", advice="add --card")
            if value is not None and not value.strip():
                raise SettingsError(
                    "no text given", where=f"--{name}", advice="add the text, or leave the option out"
                )

    def files(self, table: Path) -> dict[str, Path]:
        """The files beside the table.

        Raises:
            SettingsError: the table is not Parquet.
        """
        if not self.card:
            return {}
        from slipwise.inspection import files_beside

        if table.suffix != ".parquet":
            raise SettingsError(
                "a data set to share is Parquet", where=str(table), advice="end the name of -o in .parquet"
            )
        return files_beside(table)

    def without_names(self, log: Log) -> Log:
        """Return the log, anonymised where that was asked for.

        Raises:
            LogError: the log has no column that is to be kept.
        """
        if not self.anonymise:
            return log
        from slipwise.logs import anonymised

        return anonymised(log, keep=[name.strip() for name in (self.keep or "").split(",") if name.strip()])

    def write_beside(self, table: Path, progress: Callable[[str, float], None]) -> None:
        """Write the files beside the table, where they were asked for.

        Raises:
            SlipwiseError: nothing in the log can be predicted, or a file cannot be written.
        """
        if not self.card:
            return
        from slipwise.inspection import Stated, write_beside

        given = {"licence": self.licence, "vehicle": self.robot, "sensors": self.sensors}
        stated = Stated(**{name: value for name, value in given.items() if value is not None})
        write_beside(table, stated, anonymised=self.anonymise, progress=progress)
