# SPDX-License-Identifier: Apache-2.0
"""Writes what a terrain classifier says about each window as a table."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise.files import write_text_whole
from slipwise.terrain.classifier import Answer
from slipwise.terrain.windows import Windows


def write_labels(path: Path, windows: Windows, answer: Answer, labels: NDArray[np.object_]) -> Path:
    """Write `run,t_start,t_end,label,p_<surface>...,p_unknown`, a row for each window that has a label.

    The probabilities of the surfaces add up to 1: they are those if the surface is one that was trained.

    Args:
        path: the CSV file.
        windows: the windows, [N].
        answer: what the classifier says about them.
        labels: the surface, or "unknown", of each, [N]; empty where no sensor said anything.

    Raises:
        OutputError: the file cannot be written.
    """
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(
        ["run", "t_start", "t_end", "label", *(f"p_{name}" for name in answer.surfaces), "p_unknown"]
    )
    for k in np.flatnonzero(labels != ""):
        odds = [*answer.probability[k].tolist(), float(answer.unknown[k])]
        numbers = ["" if math.isnan(value) else f"{value:.4f}" for value in odds]
        rows.writerow(
            [windows.run[k], f"{windows.start[k]:.3f}", f"{windows.end[k]:.3f}", labels[k], *numbers]
        )
    write_text_whole(path, text.getvalue())
    return path
