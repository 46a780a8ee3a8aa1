# SPDX-License-Identifier: Apache-2.0
"""The command line and a log to damage, as the tests of the command line have them."""

from cli.conftest import _slipping, columns, drive_csv, folder, process, slipwise

__all__ = ["_slipping", "columns", "drive_csv", "folder", "process", "slipwise"]
