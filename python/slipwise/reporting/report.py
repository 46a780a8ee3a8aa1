# SPDX-License-Identifier: Apache-2.0
"""Writing the report: its sections in order, whole or not at all."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from slipwise.calibration.result import Calibration
from slipwise.evaluation.result import Evaluation
from slipwise.files import write_text_whole
from slipwise.logs.log import Log
from slipwise.reporting.contents import Contents, Section
from slipwise.reporting.page import page
from slipwise.reporting.sections.convergence import ConvergenceSection
from slipwise.reporting.sections.errors import ErrorsSection
from slipwise.reporting.sections.ground import GroundSection
from slipwise.reporting.sections.left_out import LeftOutSection
from slipwise.reporting.sections.nis import NisSection
from slipwise.reporting.sections.paths import PathsSection
from slipwise.reporting.sections.provenance import ProvenanceSection
from slipwise.reporting.sections.scores import ScoresSection
from slipwise.reporting.sections.shares import SharesSection
from slipwise.reporting.sections.surfaces import SurfacesSection
from slipwise.reporting.sections.verdict import VerdictSection

SECTIONS: tuple[Section, ...] = (
    VerdictSection(),
    ScoresSection(),
    PathsSection(),
    ErrorsSection(),
    NisSection(),
    ConvergenceSection(),
    SharesSection(),
    GroundSection(),
    SurfacesSection(),
    LeftOutSection(),
    ProvenanceSection(),
)


def write_report(  # noqa: PLR0913 - the three results of a session, and how to call the page
    path: Path,
    *,
    log: Log,
    calibration: Calibration,
    evaluation: Evaluation,
    title: str,
    command: str = "",
    model: Path = Path("model.yaml"),
    sections: Sequence[Section] = SECTIONS,
) -> Path:
    """Write one self-contained HTML page that works offline; the same input gives the same bytes.

    Args:
        path: the file to write.
        log: what was recorded.
        calibration: what was learned.
        evaluation: how well it predicts.
        title: heading of the page, any text.
        command: the command line, shown as provenance.
        model: where the model was written, for the commands that come next.
        sections: what the page shows, the first at once and the others folded under their headings;
            `SECTIONS` plus one's own for an extended report.

    Returns:
        The path that was written.

    Raises:
        OutputError: the file cannot be written.
    """
    contents = Contents(
        log=log, calibration=calibration, evaluation=evaluation, title=title, command=command, model=model
    )
    write_text_whole(path, page(contents, sections))
    return path
