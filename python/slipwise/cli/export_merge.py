# SPDX-License-Identifier: Apache-2.0
"""`slipwise export --merge`: a model's numbers in the parameter file that a robot runs with."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.cli.output import Output
    from slipwise.export import ExportOptions, Merged
    from slipwise.models import Model

_NO_PARAMETERS = ("px4", "ardupilot", "c-header", "mounts")  # no files of ROS nodes


def merge_into(
    out: Output,
    model: Model,
    model_name: str,
    target: str,
    options: ExportOptions,
    files: tuple[Path, Path | None],
) -> int:
    """Show what changes in a user's file, and write it where an output is named.

    Args:
        out: for people or programs.
        model: a learned model.
        model_name: of its file.
        target: whose numbers; `all` takes every node that the file has.
        options: what the model does not hold.
        files: the user's file, and the one to write; none is written where there is none.

    Raises:
        ModelError: the model does not fit, or the file is set up for something else.
        SettingsError: it is no parameter file, or has no such node.
    """
    from slipwise.cli.document import head
    from slipwise.cli.output import Column
    from slipwise.cli.tables import show_files
    from slipwise.cli.writable import refuse_unwritable
    from slipwise.files import write_text_whole

    source, written = files
    if written is not None and written.is_dir():
        written = written / source.name
    text = _text(source)
    merged, left_out = _merged(model, model_name, target, options, (text, str(source)))
    paths = {} if written is None else {target: written}
    refuse_unwritable(*paths.values(), out.written_file, inputs=[] if written == source else [source])
    if written is not None:
        write_text_whole(written, merged.text)
    changes = [
        {"parameter": each.name, "old": each.old or None, "new": each.new, "why": each.why}
        for each in merged.changes
    ]
    document = {"exit_code": 0, "files": paths, "changes": changes, "kept": dict(merged.kept)}
    out.document(head("export") | document | {"left_out": left_out})
    rows = [(each.name, each.old or "-", each.new, each.why) for each in merged.changes]
    columns = (Column("parameter", whole=True), Column("old"), Column("new"), Column("why"))
    if rows:
        out.table(f"Changes of {source.name}", columns, rows)
    else:
        out.line(f"Nothing of {source.name} changes.")
    for name, reason in merged.kept.items():
        out.line(f"{name} stays as it is: {reason}")
    for name, reason in left_out.items():
        out.line(f"{name} skipped: {reason}")
    if written is None and rows:
        out.line("Nothing was written: name the file with -o.")
    show_files(out, paths)
    return 0


def _text(source: Path) -> str:
    from slipwise.errors import SettingsError

    try:
        return source.read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError) as problem:
        raise SettingsError(
            f"cannot be read: {problem}", where=str(source), advice="give a parameter file of text"
        ) from None


def _merged(
    model: Model, model_name: str, target: str, options: ExportOptions, source: tuple[str, str]
) -> tuple[Merged, dict[str, str]]:
    """Merge one target, or all that the file has nodes for; say why others are left out."""
    from slipwise.errors import ModelError, SettingsError
    from slipwise.export import TARGETS, Merged, options_of

    if target not in _NO_PARAMETERS:
        options = options_of(*source, options)
    if target != "all":
        return _merged_target(model, model_name, target, options, source), {}
    text, where = source
    merged, left_out = Merged(text), {}
    for each in TARGETS:
        if each.name in _NO_PARAMETERS:
            continue
        try:
            one = _merged_target(model, model_name, each.name, options, (merged.text, where))
        except (ModelError, SettingsError) as found:
            left_out[each.name] = str(found)
        else:
            merged = Merged(one.text, merged.changes + one.changes, {**merged.kept, **one.kept})
    if left_out and not merged.changes and not merged.kept:
        raise ModelError("; ".join(f"{name}: {reason}" for name, reason in left_out.items()))
    return merged, left_out


def _merged_target(
    model: Model, model_name: str, target: str, options: ExportOptions, source: tuple[str, str]
) -> Merged:
    from slipwise.errors import SettingsError
    from slipwise.export import export_model, merge_firmware, merge_parameters

    if target in ("c-header", "mounts"):
        what = "a C header is" if target == "c-header" else "mounts are"
        raise SettingsError(f"{what} no parameter file", where="--merge", advice="export without --merge")
    if target in _NO_PARAMETERS:
        made = export_model(model, target, name=model_name, options=options, force=True)
        return merge_firmware(*source, made.text, made.kept)
    made = export_model(model, target, name=model_name, options=options, force=True)
    assert made.parameters is not None
    return merge_parameters(*source, made.parameters, options)
