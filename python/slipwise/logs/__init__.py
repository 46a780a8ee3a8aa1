# SPDX-License-Identifier: Apache-2.0
"""Logs: everything a robot recorded, read from tables and bags into one form."""

from slipwise.logs.anonymise import anonymised
from slipwise.logs.log import Inputs, LeftOut, Log, Poses, Run, Source, empty_poses
from slipwise.logs.open_log import open_log
from slipwise.logs.options import LogOptions
from slipwise.logs.save_log import save_log
from slipwise.logs.survey import Part, Survey, survey_log

__all__ = [
    "Inputs",
    "LeftOut",
    "Log",
    "LogOptions",
    "Part",
    "Poses",
    "Run",
    "Source",
    "Survey",
    "anonymised",
    "empty_poses",
    "open_log",
    "save_log",
    "survey_log",
]
