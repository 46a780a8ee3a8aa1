# SPDX-License-Identifier: Apache-2.0
"""The command line as a user would type it again."""

from __future__ import annotations

import shlex
import sys

from slipwise.addresses import masked


def command_line() -> str:
    """Return `slipwise` and its arguments, quoted where needed."""
    return shlex.join(["slipwise", *map(masked, sys.argv[1:])])
