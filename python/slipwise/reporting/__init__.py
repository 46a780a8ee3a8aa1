# SPDX-License-Identifier: Apache-2.0
"""The report: one self-contained HTML page about a log, the model learned from it and its scores."""

from slipwise.reporting.contents import Contents, Section
from slipwise.reporting.figure import Figure
from slipwise.reporting.report import SECTIONS, write_report

__all__ = ["SECTIONS", "Contents", "Figure", "Section", "write_report"]
