# SPDX-License-Identifier: Apache-2.0
"""What to do after a verdict, in a few lines."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipwise.calibration import Verdict
    from slipwise.models.schema import VerdictSection


def after_learning(verdict: Verdict | VerdictSection, model: Path) -> tuple[str, ...]:
    """Say what to do with a model that was just learned, or with the robot."""
    if not verdict.good:
        return _instead(verdict)
    name = quote(str(model))
    return (
        "Next: check it on another day, then export it:",
        f"  slipwise evaluate OTHER_LOG --model {name}",
        f"  slipwise export {name} --to all -o config",
    )


def after_checking(verdict: Verdict | VerdictSection, model: Path) -> tuple[str, ...]:
    """Say what to do with a model file that was checked on a log it had not learned from."""
    if not verdict.good:
        return _instead(verdict)
    return ("Next: export it:", f"  slipwise export {quote(str(model))} --to all -o config")


def _instead(verdict: Verdict | VerdictSection) -> tuple[str, ...]:
    if verdict.advice:
        return ("Next: do what the lines below say, then calibrate again.",)
    return ("Next: keep to the commands or wheel speeds as they are; slipwise has nothing to add to them.",)
