# SPDX-License-Identifier: Apache-2.0
"""Saves a log in the format that the ending of the file's name asks for."""

from __future__ import annotations

from pathlib import Path

from slipwise.argument_types import check_arguments
from slipwise.errors import LogError, OutputError
from slipwise.logs.gyro import gyro_alone
from slipwise.logs.log import LeftOut, Log


def save_log(log: Log, path: str | Path) -> tuple[LeftOut, ...]:
    """Write the log to a .csv, .csv.gz, .parquet or .mcap file, whole or not at all.

    The tables read back equal; an MCAP file carries commands, wheels and poses of one source, to the
    nanosecond, but no other columns.

    Returns:
        what the format cannot hold, counted.

    Raises:
        OutputError: the ending is not one of these, or the file cannot be written.
        LogError: the log has neither poses nor turns of a gyro, or the format holds no such inputs or poses.
    """
    check_arguments(save_log, locals())
    path = Path(path)
    if not any(len(run.poses) for run in log.runs) and not gyro_alone(log.runs):
        raise LogError(
            "the log has no poses to write",
            where=", ".join(source.path for source in log.sources),
            advice="`slipwise inspect` says what was left out of it, and why",
        )
    if path.name.endswith(".mcap"):
        from slipwise.logs.write_bag import write_mcap

        return write_mcap(log, path)
    from slipwise.logs.write_tidy import write_csv, write_parquet

    if path.name.endswith((".csv", ".csv.gz")):
        write_csv(log, path, compressed=path.name.endswith(".gz"))
    elif path.name.endswith(".parquet"):
        write_parquet(log, path)
    else:
        advice = "end the name in .csv, .csv.gz, .parquet or .mcap"
        raise OutputError("unknown kind of log file", where=str(path), advice=advice)
    return ()
