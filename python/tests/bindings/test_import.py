# SPDX-License-Identifier: Apache-2.0
"""The compiled core is imported where NumPy is not installed: a build in isolation writes its stub there."""

import subprocess
import sys

from slipwise import _core

_IMPORT = """
import importlib.util, sys
sys.modules["numpy"] = None  # as if it were not installed
spec = importlib.util.spec_from_file_location("_core", sys.argv[1])
spec.loader.exec_module(importlib.util.module_from_spec(spec))
"""


def test_the_core_is_imported_without_numpy() -> None:
    done = subprocess.run(
        [sys.executable, "-c", _IMPORT, _core.__file__], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
