# SPDX-License-Identifier: Apache-2.0
"""What these tests share with those of slipwise: a command line that runs in the process, and a folder."""

from cli.conftest import folder, slipwise

__all__ = ["folder", "slipwise"]
