# SPDX-License-Identifier: Apache-2.0
"""Settings of learning, from TOML or keywords; defaults that the core has stand in the core alone."""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, BaseModel, Field, ValidationError

from slipwise import _core, plugins
from slipwise.argument_types import check_arguments
from slipwise.calibration.gone_keys import moved, notes_of_gone, without
from slipwise.calibration.keys import changed_or_key, key, keys_of
from slipwise.calibration.learning_tables import (
    SEGMENT_SECONDS,
    AutoTable,
    BasisTerms,
    BodyForceTable,
    ChangeTable,
    FilterTable,
    NoiseTable,
    PriorTable,
    Section,
    SegmentTable,
    SensorExtrinsicsTable,
    SlipDisturbanceTable,
    SmoothingTable,
)
from slipwise.calibration.live_table import LiveTable
from slipwise.calibration.log_table import LogTable
from slipwise.calibration.source_tables import PoseSourceTable
from slipwise.errors import OlderNames, SettingsError
from slipwise.files import read_whole
from slipwise.logs.options import LogOptions
from slipwise.models.upgrade import RENAMED_SETTINGS, with_new_keys
from slipwise.segments import WindowRules

if TYPE_CHECKING:
    from slipwise.models.model import Model
from slipwise.validation_text import first_problem

MAX_BYTES = 1024 * 1024  # of a settings file
_SEE = "docs/settings.md lists the keys and what they take"
AVERAGE = "average"  # the estimator that weighs bases, each learned by a causal filter
NOMINAL_WHEEL_SEPARATION = 0.6  # m, about a Husky's, where nothing gives it


def _known_estimator(name: str) -> str:
    """Return the name of an estimator.

    Raises:
        SlipwiseError: it comes with a package that is not installed.
    """
    if name == AVERAGE:
        return name
    plugins.refuse_missing(plugins.ESTIMATORS, name)
    known = (AVERAGE, *plugins.added(plugins.ESTIMATORS))
    if name not in known:
        raise ValueError(f"unknown estimator '{name}'; known are {', '.join(known)}")
    return name


class Settings(Section):
    """Everything that changes the learned model."""

    basis: str = key(
        "auto", '"auto", "custom" (the terms below), "none", or a named basis (choosing-a-model.md)'
    )
    estimator: Annotated[str, AfterValidator(_known_estimator)] = key(
        AVERAGE,
        'of bases; slipwise-thesis adds "iekf", "delayed-state", "ekf-thesis", "gradient-descent", "batch"',
    )
    pose_sources: list[PoseSourceTable] = key(
        [], "of poses beside the first, a table [[pose_sources]] each: what-was-measured.md"
    )
    terms: BasisTerms = BasisTerms()
    learn_clock_offset: bool = True  # wheel input; from commands the offset is part of the delay
    segment: SegmentTable = SegmentTable()
    prior: PriorTable = PriorTable()
    filter: FilterTable = FilterTable()
    noise: NoiseTable = NoiseTable()
    auto: AutoTable = AutoTable()
    slip_disturbance: SlipDisturbanceTable = SlipDisturbanceTable()
    body_force: BodyForceTable = BodyForceTable()
    change: ChangeTable = ChangeTable()
    smoothing: SmoothingTable = SmoothingTable()
    sensor_extrinsics: SensorExtrinsicsTable = SensorExtrinsicsTable()
    log: LogTable = LogTable()
    live: LiveTable = Field(LiveTable(), exclude=True)  # says nothing of how a log is learned

    def __repr__(self) -> str:
        changed = self.model_dump(exclude_defaults=True)
        return f"Settings({', '.join(f'{name}={value!r}' for name, value in changed.items())})"

    @property
    def wheel_separation(self) -> float:
        """The distance between left and right wheels [m]; the search for limits of the sides uses it."""
        return self.log_options().wheel_separation or NOMINAL_WHEEL_SEPARATION

    def segment_length(self, input_name: str) -> float:
        """Return the length of the segments to learn from [s]."""
        return self.segment.length or SEGMENT_SECONDS[input_name]

    def rules(self) -> WindowRules:
        """Return the rules of cutting windows."""
        return WindowRules(self.segment.unknown_after, sensor=self.sensor_extrinsics.pose)

    def log_options(self, **given: Any) -> LogOptions:
        """Return the options for `open_log`: those of [log], and `given` ones before them."""
        return self.log.options(self.segment.unknown_after, given)

    def filter_settings(self) -> _core.CausalFilterSettings:
        """Return the core's settings of one causal filter."""
        settings = _core.CausalFilterSettings()
        prior, iekf, noise = _core.PriorSettings(), _core.IekfSettings(), _core.NoiseSettings()
        _copy(self.prior, prior)
        prior.sensor = _core.Pose2(*self.sensor_extrinsics.pose)
        _copy(self.filter, iekf)
        table = self.noise
        noise.shape = _core.MotionNoise(
            table.psd_time, table.psd_motion, table.fraction, table.pose_std_xy, table.pose_std_yaw
        )
        noise.adapt = table.adapt
        settings.prior, settings.iekf, settings.noise = prior, iekf, noise
        settings.force = self.body_force.law()
        settings.branches = self._branches()
        return settings

    def _branches(self) -> _core.BranchSettings:
        branches = _core.BranchSettings()
        branches.follow = self.change.branches
        return branches

    def choosing(self, basis: str | None, estimator: str | None) -> Settings:
        """Return these settings with another basis or estimator, where one is given.

        Raises:
            SettingsError: there is no such estimator.
        """
        given = {"basis": basis, "estimator": estimator}
        chosen = make_settings(self.model_dump() | {key: name for key, name in given.items() if name})
        return chosen.model_copy(update={"live": self.live})

    def bases(self) -> list[_core.Basis]:
        """Return the bases to learn: several for `auto`, otherwise one.

        Raises:
            SettingsError: a basis or a term is unknown.
        """
        names = self.auto.bases if self.basis == "auto" else [self.basis]
        try:
            return [self._basis(name) for name in names]
        except ValueError as problem:
            raise SettingsError(str(problem), where="basis") from problem

    def _basis(self, name: str) -> _core.Basis:
        if name == "custom":
            if not (self.terms.lon or self.terms.lat or self.terms.ang):
                raise ValueError(
                    'the custom basis has no terms; write some under [terms], such as lon = ["V"]'
                )
            return _core.Basis("custom", self.terms.lon, self.terms.lat, self.terms.ang)
        return _core.Basis("none", [], [], []) if name == "none" else _core.named_basis(name)


def load_settings(path: str | Path, changes: Mapping[str, Any] | None = None) -> Settings:
    """Read settings from a TOML file; `changes`, nested dictionaries, go before it.

    Raises:
        SettingsError: the file is missing, not TOML, or has an unknown key or a wrong value.
    """
    check_arguments(load_settings, locals())
    path = Path(path)
    try:
        content = tomllib.loads(read_whole(path, most=MAX_BYTES, error=SettingsError).decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise SettingsError(
            f"not a TOML file: {problem}", where=str(path), advice='write lines like basis = "auto"'
        ) from problem
    return user_settings(merged(content, changes or {}), where=str(path))


def merged(content: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return nested dictionaries with the changes in them."""
    result = dict(content)
    for name, value in changes.items():
        inner = result.get(name)
        if isinstance(inner, dict) and isinstance(value, dict):
            value = merged(inner, value)
        result[name] = value
    return result


def make_settings(content: dict[str, Any], *, where: str = "settings", saved: bool = False) -> Settings:
    """Check settings given as nested dictionaries, constants that benchmarks vary among them.

    Args:
        content: by key.
        where: for messages.
        saved: slipwise wrote them, and older names are no news.

    Raises:
        SettingsError: a key is unknown or a value is wrong.
    """
    check_arguments(make_settings, locals())
    present, news = _with_new_keys(content)
    if not saved:
        _note(where, news)
    return _validated(present, where)


def sensor_of(model: Model) -> tuple[float, float, float]:
    """Return where the settings of a model say that its pose sensor sits: x, y [m], yaw [rad]."""
    given = {"sensor_extrinsics": model.content.provenance.settings.get("sensor_extrinsics", {})}
    return make_settings(given, where="settings in the model file", saved=True).sensor_extrinsics.pose


def user_settings(content: dict[str, Any], *, where: str) -> Settings:
    """Check settings that a user wrote; notes keys that users no longer have, and reads them.

    Raises:
        SettingsError: a key is unknown or a value is wrong.
    """
    present, news = _with_new_keys(content)
    _note(where, news)
    settings = _validated(present, where)
    kept = [text for _, text in notes_of_gone(present)]  # those that nothing reads are out
    _note(where, [*kept, "read in this release once more"] if kept else [])
    return settings


def _validated(present: dict[str, Any], where: str) -> Settings:
    try:
        return Settings.model_validate(present)
    except ValidationError as problem:
        raise SettingsError(first_problem(problem), where=where, advice=_SEE) from problem


def users_dump(settings: Settings) -> dict[str, Any]:
    """Return what a settings file holds of them: keys of users, and constants that were changed."""
    keys = {each.path for each in keys_of(Settings)}
    return changed_or_key(settings.model_dump(exclude_none=True), Settings().model_dump(), keys)


def _note(where: str, news: list[str]) -> None:
    if news:
        warnings.warn(f"{where}: older names of settings: {', '.join(news)}", OlderNames, stacklevel=4)


def _with_new_keys(content: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return the same under the present names of keys, without those that nothing reads; and what changed."""
    live = content.get("live")
    news: list[str] = []
    if isinstance(live, dict) and ("vehicle" in live or isinstance(live.get("memory"), str)):
        live, news = _older_live(live)
        content = content | {"live": live}
    news += [f"{name} is {new} now" for place, name, new in _RENAMED if name in _table(content, place)]
    renamed = with_new_keys(content, RENAMED_SETTINGS)
    assert isinstance(renamed, dict)
    if _table(renamed, "vehicle").get("wheel_separation") == NOMINAL_WHEEL_SEPARATION:
        renamed = without(renamed, ("vehicle.wheel_separation",))  # the default, which every file has
    present, elsewhere = moved(renamed)
    unread = [(path, text) for path, text in notes_of_gone(present) if not _known(Settings, path)]
    news += [*elsewhere, *(f"{text}; what stands there is not read" for _, text in unread)]
    return without(present, [path for path, _ in unread]), news


def _known(table: type[BaseModel], path: str) -> bool:
    """Whether a table has such a field."""
    name, _, rest = path.partition(".")
    field = table.model_fields.get(name)
    if field is None or not rest:
        return field is not None
    inner = field.annotation
    return isinstance(inner, type) and issubclass(inner, BaseModel) and _known(inner, rest)


def _older_live(live: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return [live] of version 0.2 with present keys, and what moved: there `name` was that of the node."""
    live, moved = dict(live), []
    if "vehicle" in live:
        moved = ["live.vehicle is live.name now", *(["live.name is live.node now"] if "name" in live else [])]
        live = {{"vehicle": "name", "name": "node"}.get(key, key): value for key, value in live.items()}
    if isinstance(live.get("memory"), str) and live.get("model", live["memory"]) == live["memory"]:
        live |= {"model": live["memory"], "memory": True}
        moved.append("the model of live.memory is live.model now")
    return live, moved


_RENAMED = [(place, old, new) for place, names in RENAMED_SETTINGS.items() for old, new in names.items()]


def _table(content: dict[str, Any], place: str) -> dict[str, Any]:
    table = content.get(place) if place else content
    return table if isinstance(table, dict) else {}


def _copy(table: Section, target: object) -> None:
    for name in type(table).model_fields:
        setattr(target, name, getattr(table, name))
