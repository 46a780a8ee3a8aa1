# SPDX-License-Identifier: Apache-2.0
"""Pictures as PNG by Matplotlib, which is loaded only here, and only when one is drawn."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from slipwise.errors import SlipwiseError
from slipwise.files import write_whole

DPI = 150


def drawing_part(name: str) -> Any:
    """Return a module of Matplotlib, such as "figure".

    Raises:
        SlipwiseError: Matplotlib is not installed.
    """
    try:
        return importlib.import_module(f"matplotlib.{name}")
    except ImportError as error:
        raise SlipwiseError(
            "pictures need Matplotlib, which is not installed",
            where=str(error),
            advice='pip install "slipwise[plot]", or leave the picture out by --no-picture',
        ) from error


def write_png(path: Path, figure: Any) -> Path:
    """Write a figure, the same bytes each time; return the path of the file.

    Raises:
        OutputError: the file cannot be written.
    """
    write_whole(
        path, lambda target: figure.savefig(target, format="png", dpi=DPI, metadata={"Software": None})
    )
    return path
