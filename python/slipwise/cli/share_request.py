# SPDX-License-Identifier: Apache-2.0
"""What `slipwise convert` was asked for beside the table: no names in it, and the files of a data set."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.errors import SettingsError

if TYPE_CHECKING:
    from slipwise.logs import Log


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
