# SPDX-License-Identifier: Apache-2.0
"""Tests that reading a table does not wait for the bag reader to load."""

import subprocess
import sys
from pathlib import Path

from slipwise.logs import Log, save_log

SCRIPT = """
import sys
from slipwise.logs import open_log
assert "rosbags" not in sys.modules and "pyarrow" not in sys.modules
open_log(sys.argv[1])
assert "rosbags" not in sys.modules
"""


def test_a_table_is_read_without_loading_rosbags(log: Log, tmp_path: Path) -> None:
    save_log(log, tmp_path / "a.csv")
    command = [sys.executable, "-c", SCRIPT, str(tmp_path / "a.csv")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
