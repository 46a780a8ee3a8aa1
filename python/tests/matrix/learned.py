# SPDX-License-Identifier: Apache-2.0
"""What a situation's log taught, learned once by `slipwise calibrate` and shared by all uses."""

from __future__ import annotations

import io
import json
from collections.abc import Generator, Iterable, Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any
from unittest.mock import patch

from matrix.simulator import Robot
from matrix.situation import Situation

from slipwise.calibration import Settings
from slipwise.cli.main import run
from slipwise.cli.options import chosen_settings
from slipwise.fleet.find_logs import LogTask
from slipwise.fleet.learned_rows import learn_task
from slipwise.fleet.process_scheduler import Outcome
from slipwise.logs import LogOptions
from slipwise.models import Model, load_model

REFUSED = 2  # exit code


class RefusalError(Exception):
    """slipwise refuses on purpose: the one line that it gives."""


@dataclass(frozen=True)
class Said:
    """What a verb said."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> dict[str, Any]:
        """Its JSON."""
        document: dict[str, Any] = json.loads(self.out)
        return document


def verb(*arguments: object) -> Said:
    """Run a verb of slipwise in this process.

    Raises:
        RefusalError: it ends with exit code 2; AssertionError where that is a fault, not a refusal.
    """
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        code = run([str(argument) for argument in arguments])
    said = Said(code, out.getvalue(), err.getvalue())
    if code == REFUSED:
        assert "unexpected" not in said.err, said.err
        raise RefusalError(said.err.strip())
    return said


class _Here:
    """A scheduler that learns in this process: tests of fleets have others, which start with an import."""

    def run(self, tasks: Iterable[LogTask]) -> Generator[Outcome, None, None]:
        """Yield the outcome of each task."""
        for task in tasks:
            rows = learn_task(task)
            yield Outcome(task, rows, rows.failure)


@dataclass(frozen=True, eq=False)
class Learned:
    """A situation in a folder of its own."""

    situation: Situation
    folder: Path

    @cached_property
    def options(self) -> LogOptions:
        """How its logs are read."""
        return LogOptions.of(self.situation.reading(self.folder))

    @cached_property
    def reading(self) -> list[str]:
        """The same on the command line."""
        given = self.situation.reading(self.folder)
        return [text for name, value in given.items() for text in (f"--{name.replace('_', '-')}", str(value))]

    @property
    def toml(self) -> str:
        """The same as a settings file, with how its logs are read."""
        reading = [f"log.{name}={json.dumps(v)}" for name, v in self.situation.reading(self.folder).items()]
        pairs = [each.split("=", 1) for each in (*self.situation.settings, *reading)]
        return "\n".join(f"{name} = {v if not v[0].isalpha() else json.dumps(v)}" for name, v in pairs)

    @cached_property
    def chosen(self) -> Settings:
        """The settings of everything that learns, with how its logs are read."""
        reading = (f"log.{name}={value}" for name, value in self.situation.reading(self.folder).items())
        return chosen_settings(None, [*self.situation.settings, *reading])

    @cached_property
    def settings(self) -> list[str]:
        """The same on the command line."""
        return [text for each in self.situation.settings for text in ("--set", each)]

    @cached_property
    def log(self) -> Path:
        """The log that is learned from."""
        return self.situation.write(self.folder, "drive", 1)

    @cached_property
    def other(self) -> Path:
        """A log of the same robot on another day."""
        return self.situation.write(self.folder, "other", 2)

    @cached_property
    def begins(self) -> list[str]:
        """What `calibrate` begins with: a model that remembers a surface, or what a fleet knows."""
        situation = self.situation
        if situation.fleet:
            _, fleet = self.fleet("alike", {f"robot-{k}": situation.robot for k in range(3)}, days=1)
            return ["--prior", str(fleet / "fleet.yaml")]
        if situation.before is None:
            return []
        log = situation.write_drive(self.folder / "before.csv", 50, *situation.before)
        path = self.folder / "before.yaml"
        verb(
            "calibrate",
            "--memory",
            log,
            "--no-report",
            "--runs",
            self.folder / "runs",
            "-o",
            path,
            *self.common,
        )
        return ["--memory", str(path)]

    def fleet(self, name: str, robots: Mapping[str, Robot], *, days: int) -> tuple[Said, Path]:
        """Learn a fleet, each robot driven on some days; what is said, and the folder of the results."""
        logs, results = self.folder / name, self.folder / f"{name}-fleet"
        for seed, (robot, known) in enumerate(robots.items()):
            (logs / robot).mkdir(parents=True)
            for day in range(days):
                self.situation.write(logs / robot, f"day-{day}", 60 + 10 * seed + day, known)
        (logs / "fleet.toml").write_text(self.toml, encoding="utf-8")
        given = ("--settings", logs / "fleet.toml", "--json", "-")
        with patch("slipwise.cli.fleet._scheduler", lambda *_: _Here()):
            return verb("fleet", logs, "-o", results, *given), results

    @property
    def live(self) -> list[str]:
        """The same for `live`."""
        return ["--memory", "--model", self.begins[1]] if self.situation.before is not None else []

    @property
    def common(self) -> list[str]:
        """Options of everything that reads its logs and learns."""
        return [*self.reading, *self.settings, "--input", self.situation.learns]

    def calibrated(self, log: Path, name: str, *extra: object) -> Said:
        """Learn a log; the model is NAME.yaml."""
        return verb(
            *("calibrate", *self.begins, log, "--runs", self.folder / "runs", "--json", "-"),
            *("-o", self.folder / f"{name}.yaml", *self.common, *(extra or ("--no-report",))),
        )

    @cached_property
    def calibration(self) -> Said:
        """What `calibrate` says of the log."""
        return self.calibrated(self.log, "model")

    @cached_property
    def path(self) -> Path:
        """The model file."""
        assert self.calibration.code in (0, 1)
        return self.folder / "model.yaml"

    @cached_property
    def model(self) -> Model:
        """The learned model."""
        return load_model(self.path)

    def taught(self, name: str, seed: int, robot: Robot | None = None) -> Path:
        """Return the model file of another drive, of this robot or another one, learned once."""
        path = self.folder / f"{name}.yaml"
        if not path.exists():
            self.calibrated(self.situation.write(self.folder, f"{name}-log", seed, robot), name)
        return path
