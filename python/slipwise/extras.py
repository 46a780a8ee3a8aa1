# SPDX-License-Identifier: Apache-2.0
"""Says how to install what an extra of slipwise needs: the third parties by name, from any index."""

from __future__ import annotations

import re
from importlib.metadata import requires


def to_install(extra: str) -> str:
    """Return the command that installs the third parties of an extra, such as "live"."""
    named = [line.partition(";") for line in requires("slipwise") or ()]
    wanted = [what.strip() for what, _, when in named if re.search(rf"extra == ['\"]{extra}['\"]", when)]
    return "pip install " + " ".join(f"'{what}'" for what in wanted)
