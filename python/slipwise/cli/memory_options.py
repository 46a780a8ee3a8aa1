# SPDX-License-Identifier: Apache-2.0
"""What commands with `--memory` begin with: a model file among the logs, and labels of surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.calibration.learned_sequence import SequenceOptions

MODEL_ENDINGS = (".yaml", ".yml")


def split_model(paths: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """Return the model files among what was given, and the logs."""
    models = [path for path in paths if path.suffix.lower() in MODEL_ENDINGS]
    return models, [path for path in paths if path not in models]


def sequence_options(
    models: Sequence[Path], labels: Sequence[str] | None, logs: Sequence[Path]
) -> SequenceOptions:
    """Return what a sequence begins with.

    Raises:
        SettingsError: there are several models or no logs, or labels that do not go with the logs.
        ModelError: the model cannot be read.
        LogError: a table of labels cannot be read.
    """
    from slipwise.calibration.learned_sequence import SequenceOptions
    from slipwise.calibration.surface_labels import given_labels
    from slipwise.errors import SettingsError
    from slipwise.models import load_model
    from slipwise.terrain.label_file import read_labels

    if len(models) > 1:
        raise SettingsError(
            "only one model can be continued",
            where=str(models[1]),
            advice="join their surfaces first: slipwise surfaces merge A.yaml B.yaml -o C.yaml",
        )
    if not logs:
        raise SettingsError("no log given", where="--memory", advice="give logs in the order of time")
    start = load_model(models[0]) if models else None
    file = str(models[0]) if models else ""
    files = label_files(labels)
    if files and len(files) < len(labels or ()):
        raise SettingsError(
            "names and tables of surfaces cannot be mixed",
            where="--surface",
            advice="give names or tables",
        )
    if files:
        return SequenceOptions(start=start, terrain=read_labels(files), start_file=file)
    return SequenceOptions(start=start, labels=given_labels(labels or (), len(logs)), start_file=file)


def label_files(labels: Sequence[str] | None) -> list[Path]:
    """Return the tables among labels of surfaces; the others are names."""
    from slipwise.terrain.label_file import is_label_file

    return [Path(label) for label in labels or () if is_label_file(label)]


def refuse_labels(labels: Sequence[str] | None) -> None:
    """Refuse labels where nothing remembers surfaces.

    Raises:
        SettingsError: there are some.
    """
    from slipwise.errors import SettingsError

    if labels:
        raise SettingsError(
            "only a memory of surfaces uses the name of a surface", where="--surface", advice="add --memory"
        )
