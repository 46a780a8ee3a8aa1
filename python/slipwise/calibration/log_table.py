# SPDX-License-Identifier: Apache-2.0
"""The part of the settings that says how to read a log: the fields of `LogFields`, as TOML has them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, create_model

from slipwise.calibration.keys import key
from slipwise.log_fields import LOG_FIELDS, About, Kind
from slipwise.logs.options import LogOptions, RobotOptions
from slipwise.logs.unheeded import OF_SOME

_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Several = Annotated[list[str], Field(min_length=1)]  # further pose sources beside the first
_TYPES: dict[Kind, Any] = {
    Kind.text: str,
    Kind.topics: str | _Several,
    Kind.files: str | _Several,
    Kind.names: list[str],
    Kind.positive: Annotated[float, Field(gt=0.0, le=1e6, allow_inf_nan=False)],
    Kind.number: _Finite,
    Kind.number_or_auto: _Finite | Literal["auto"],
    Kind.factors: Annotated[list[_Finite], Field(min_length=2, max_length=2)],
    Kind.columns: dict[str, str],
}


class _Reading(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    def options(self, unknown_after: float, given: dict[str, Any]) -> LogOptions:
        """Return the options for `open_log`; what is `given` goes before what stands here."""
        own: dict[str, Any] = self.model_dump(exclude_defaults=True)
        if "columns" in given:
            given = given | {"columns": own.get("columns", {}) | given["columns"]}
        kind = RobotOptions if OF_SOME & own.keys() - given.keys() else LogOptions
        return kind.of({"unknown_after": unknown_after} | own | given)


_UNITS = {"METRES": "m: ", "SECONDS": "s: ", "RADIANS": "rad: "}


def _field(about: About) -> tuple[Any, Any]:
    kind = _TYPES[about.kind] if about.default is not None else _TYPES[about.kind] | None
    default = list(about.default) if isinstance(about.default, tuple) else about.default
    if not about.key:  # an option alone; read for one release from files that have it
        return kind, default
    return kind, key(default, _UNITS.get(about.metavar, "") + about.help, example=about.example)


_keys: dict[str, Any] = {about.name: _field(about) for about in LOG_FIELDS}
_Keys: Any = create_model("_Keys", __base__=_Reading, **_keys)


class LogTable(_Keys):
    """How slipwise reads a log (--help-log): it guesses what is missing; the command line goes before."""
