# SPDX-License-Identifier: Apache-2.0
"""The exceptions that slipwise raises: one root that says what failed, where, and what to do."""

from __future__ import annotations


class SlipwiseError(Exception):
    """Root of all errors about a user's input or use; the command line exits with code 2 on it.

    Args:
        what: what is wrong, in a few words.
        where: the file, line, topic or key where it is.
        advice: what to do about it.
    """

    def __init__(self, what: str, *, where: str = "", advice: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.where = where
        self.advice = advice

    def __str__(self) -> str:
        place = f" ({self.where})" if self.where else ""
        advice = f": {self.advice}" if self.advice else ""
        return " ".join(f"{self.what}{place}{advice}".split())


class LogError(SlipwiseError):
    """A log cannot be read, or holds nothing to learn from."""


class SettingsError(SlipwiseError):
    """A setting, an option or a settings file is wrong."""


class ModelError(SlipwiseError):
    """A model file is not valid, or does not fit what it is used for."""


class PlanningError(SlipwiseError):
    """There is no plan: the map, the start or the goal does not allow one."""


class OutputError(SlipwiseError):
    """A result cannot be written."""


class UnseenSpeed(UserWarning):
    """A model is asked about speeds that it has not seen."""


class OlderNames(FutureWarning):
    """A settings file has keys under names of an earlier release."""
