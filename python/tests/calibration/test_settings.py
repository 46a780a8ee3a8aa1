# SPDX-License-Identifier: Apache-2.0
"""Settings are read from TOML, every key is known, and anything else is refused with the key named."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import Settings, calibrate, load_settings, make_settings
from slipwise.calibration.core_settings import core_settings, wheelbase_of
from slipwise.calibration.gone_keys import GONE
from slipwise.calibration.keys import keys_of
from slipwise.calibration.settings import users_dump
from slipwise.errors import OlderNames, SettingsError
from slipwise.segments import WindowRules

EVERY_KEY = """
basis = "custom"
learn_clock_offset = false
pose_sources = [{ name = "rtk", x = 0.3, late = 0.1 }]
estimator = "iekf"

[terms]
lon = ["V", "V*abs(w)"]
lat = ["w"]
ang = ["w", "V*w"]

[segment]
length = 1.5
unknown_after = 0.4

[prior]
slip_fraction = 0.2
clock_offset_std = 0.1
time_constant = 0.5
delay = 0.2

[filter]
huber = 2.0

[noise]
psd_time = [1e-5, 1e-5, 1e-5]
psd_motion = [2e-3, 2e-3, 2e-3]
fraction = [0.04, 0.04, 0.04]
pose_std_xy = 0.01
pose_std_yaw = 0.005
adapt = false

[auto]
bases = ["custom", "edd-2"]
structures = ["joint", "direct"]

[slip_disturbance]
learn = false

[change]
branches = false

[smoothing]
smooth = true
drift = "random-walk"
length = 20.0

[log]
command_topic = "/c"
pose_topic = "/p"
wheel_topic = "none"
imu_topic = "/i"
pose_frame = "map"
child_frame = "robot"
left_joints = ["l"]
right_joints = ["r"]
wheel_radius = 0.1
wheel_separation = 0.5
wheelbase = 1.2
vehicle = "husky"
command_scale = [0.5, 1.0]
wheel_scale = [0.1, -1.0]
pose_yaw_offset = 0.2
poses = "p.txt"
pose_clock_offset = 1.5
command_timeout = 0.6
start = 1.0
end = 2.0
columns = {}

[body_force]
frame = "none"
time_constant = 90.0
std = 0.02

[sensor_extrinsics]
x = 1.5
y = -0.2
yaw = 0.1
learn = true
"""


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "settings.toml"
    path.write_text(text, encoding="utf-8")
    return path


def key_paths(table: object, at: str = "") -> set[str]:
    if not isinstance(table, dict):
        return {at}
    return {key for name, value in table.items() for key in key_paths(value, f"{at}.{name}".strip("."))}


def test_every_key_and_constant_is_accepted_and_reaches_its_place() -> None:
    settings = make_settings(tomllib.loads(EVERY_KEY))
    assert key_paths(settings.model_dump(exclude_unset=True)) == key_paths(Settings().model_dump())
    assert settings.rules() == WindowRules(0.4, sensor=(1.5, -0.2, 0.1))
    assert settings.segment_length("wheel") == settings.segment_length("command") == 1.5
    core = settings.filter_settings()
    force = core.force
    assert (force.time_constant, force.std, force.turn_std) == (0.0, 0.02, 0.02)  # none is learned
    assert (core.prior.slip_fraction, core.prior.time_constant, core.prior.delay) == (0.2, 0.5, 0.2)
    assert core.prior.clock_offset_std == 0.1
    assert core.prior.sensor.vector().tolist() == [1.5, -0.2, 0.1]
    assert core.iekf.huber == 2.0
    assert core.noise.shape.psd_motion == [2e-3, 2e-3, 2e-3]
    assert core.noise.shape.fraction == [0.04, 0.04, 0.04]
    assert (core.noise.shape.pose_std_xy, core.noise.shape.pose_std_yaw) == (0.01, 0.005)
    assert core.noise.adapt is False
    assert settings.wheel_separation == 0.5
    log = settings.log_options()
    assert (log.command_topic, log.pose_topic, log.wheel_topic, log.imu_topic) == ("/c", "/p", "none", "/i")
    assert (log.pose_frame, log.child_frame, log.left_joints, log.right_joints) == (
        "map",
        "robot",
        ("l",),
        ("r",),
    )
    assert (log.wheel_radius, log.wheel_separation, log.wheelbase, log.poses) == (
        0.1,
        0.5,
        1.2,
        Path("p.txt"),
    )
    assert (log.command_scale, log.wheel_scale) == ((0.5, 1.0), (0.1, -1.0))
    assert log.pose_yaw_offset == 0.2
    assert (log.pose_clock_offset, log.start, log.end, log.unknown_after) == (1.5, 1.0, 2.0, 0.4)
    assert log.command_timeout == 0.6
    drift = settings.smoothing.drift_settings()
    assert (drift.drift, drift.length) == (_core.Drift.RandomWalk, 20.0)
    assert not settings.filter_settings().branches.follow
    assert Settings().filter_settings().branches.follow
    learner = core_settings(settings, "command", (1.0, 4.0))
    assert not learner.learn_disturbance
    assert (learner.stream.from_commands, learner.stream.segment_length) == (True, 1.5)
    assert (learner.stream.unknown_after, learner.stream.horizons) == (0.4, [1.0, 4.0])
    assert (learner.hypotheses.dynamics, learner.hypotheses.sensor_extrinsics) == (True, True)
    assert not learner.hypotheses.several  # a basis of one's own is learned alone
    auto = core_settings(settings.choosing("auto", None), "command", ()).hypotheses
    assert (auto.cascaded, auto.direct, auto.baseline) == (False, True, False)
    assert [each.name for each in auto.bases] == ["custom", "edd-2"]
    (basis,) = settings.bases()
    assert (basis.lon, basis.lat, basis.ang) == (["V", "V*abs(w)"], ["w"], ["w", "V*w"])


def every_path(model: type[BaseModel], at: str = "") -> set[str]:
    """Return the paths of all fields in nested tables."""
    found = set()
    for name, about in model.model_fields.items():
        inner, path = about.annotation, f"{at}.{name}".strip(".")
        nested = isinstance(inner, type) and issubclass(inner, BaseModel)
        found |= every_path(inner, path) if nested else {path}
    return found


def test_users_have_few_keys_and_hear_what_holds_in_place_of_older_ones(tmp_path: Path) -> None:
    keys = {each.path for each in keys_of(Settings)}
    assert len(keys) <= 40
    constants = every_path(Settings) - keys
    assert constants <= GONE.keys() | {"live.vehicle", "live.wheelbase"}
    assert not keys & GONE.keys()
    content = {
        "auto": {"structures": ["joint"]},
        "live": {"save_every": 9.0, "host": "::1"},
        "vehicle": {"wheel_separation": 1.08},
        "filter": {"huber": 3.0},
    }
    with pytest.warns(OlderNames) as said:
        settings = load_settings(written(tmp_path, ""), content)
    notes = " ".join(str(each.message) for each in said)
    for words in (
        "auto.structures is gone: slipwise keeps the one that predicts best",
        "filter.huber is a constant of slipwise",
        "live.save_every is gone: the cache is written every 60 s; what stands there is not read",
        "live.host is live.address now",
        "vehicle.wheel_separation is log.wheel_separation now",
    ):
        assert words in notes
    assert (settings.filter.huber, settings.wheel_separation, settings.live.host) == (3.0, 1.08, "::1")
    assert users_dump(settings)["filter"] == {"huber": 3.0}  # a folder of a run gives the same again
    assert key_paths(users_dump(Settings())) <= keys


def test_lags_act_on_the_steering_where_it_is_commanded_alone() -> None:
    learned = [
        core_settings(Settings(), name, (1.0,), wheelbase=0.5).hypotheses for name in ("command", "wheel")
    ]
    assert [each.wheelbase for each in learned] == [0.5, 0.0]
    assert wheelbase_of(make_settings({"log": {"vehicle": "f1tenth"}})) is not None
    assert wheelbase_of(make_settings({"log": {"vehicle": "dart"}})) is None  # of throttle and steering


def test_every_key_set_still_calibrates() -> None:
    settings = make_settings(tomllib.loads(EVERY_KEY))
    model = calibrate(simulated_log(Drive(seconds=40.0)), input="wheel", settings=settings).model
    names = [parameter.name for parameter in model.content.parameters]
    assert names == [
        "lon.V",
        "lon.V*abs(w)",
        "lat.w",
        "ang.w",
        "ang.V*w",
        "sensor_x",
        "sensor_y",
        "sensor_yaw",
    ]


def test_defaults_are_those_of_the_core() -> None:
    settings, core = Settings(), _core.CausalFilterSettings()
    ours = settings.filter_settings()
    for table in ("prior", "iekf"):
        one, other = getattr(ours, table), getattr(core, table)
        names = [name for name in dir(one) if not name.startswith("_") and name != "sensor"]
        assert {name: getattr(one, name) for name in names} == {name: getattr(other, name) for name in names}
    for prior in (ours.prior, core.prior):
        assert not prior.sensor.vector().any()
    assert ours.branches.follow is core.branches.follow
    assert settings.rules() == WindowRules()
    assert load_settings_of_nothing() == settings


def load_settings_of_nothing() -> Settings:
    return make_settings({})


def test_wrong_settings_are_refused_with_the_key_and_the_file(
    tmp_path: Path, subtests: pytest.Subtests
) -> None:
    for text, message in [
        ("colour = 1", "colour: there is no such key"),
        ("[filter]\nhubber = 2.0", r"filter\.hubber: there is no such key"),
        ("[filter]\nhuber = nan", r"filter\.huber"),
        ("[prior]\ntime_constant = -1.0", r"prior\.time_constant: must be at least 1e-06"),
        ("[prior]\ntime_constant = inf", r"prior\.time_constant"),
        ("[noise]\npsd_time = [1.0]", r"noise\.psd_time"),
        ("[noise]\npsd_motion = [-1.0, 0.0, 0.0]", r"noise\.psd_motion"),
        ("[noise]\nfraction = [nan, 0.0, 0.0]", r"noise\.fraction"),
        ("[auto]\nstructures = []", r"'joint' must be among the structures"),
        ('[auto]\nstructures = ["joint", "other"]', r"auto\.structures"),
        ("[auto]\nbases = []", r"auto\.bases"),
        ("[segment]\nlength = 0.0", r"segment\.length"),
        ("[noise]\npose_std_yaw = 1e12", r"noise\.pose_std_yaw: must be at most 1e\+06"),
        ("[noise]\nfraction = [1e300, 0.0, 0.0]", r"noise\.fraction\.0: must be at most 1e\+06"),
        ("[prior]\nclock_offset_std = 1e300", r"prior\.clock_offset_std: must be at most 100"),
        ("[prior]\nslip_fraction = 1e-300", r"prior\.slip_fraction: must be at least 1e-09"),
        ("[vehicle]\ntrack = 1000000000", r"log\.wheel_separation: must be at most 1e\+06"),
        ("basis = 3", "basis: must be text, not 3"),
        ("basis", r"not a TOML file: .*write lines like basis = \"auto\""),
        ("basis = 'a'\nbasis = 'b'", "not a TOML file"),
    ]:
        with subtests.test(text=text, message=message):
            path = written(tmp_path, text)
            with pytest.raises(SettingsError, match=message) as caught:
                load_settings(path)
            assert caught.value.where == str(path)
            assert caught.value.advice


def test_file_that_is_no_text_or_missing_is_refused(tmp_path: Path) -> None:
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SettingsError, match="not a TOML file"):
        load_settings(tmp_path / "b.toml")
    with pytest.raises(SettingsError, match=r"cannot read: No such file .*: check the path"):
        load_settings(tmp_path / "none.toml")


def test_unknown_basis_is_refused_with_the_known_ones() -> None:
    with pytest.raises(SettingsError, match=r"magic-7.*edd-2"):
        make_settings({"basis": "magic-7"}).bases()
    with pytest.raises(SettingsError, match="magic-7"):
        make_settings({"auto": {"bases": ["edd-2", "magic-7"]}}).bases()


def test_wrong_term_is_refused_with_its_text(subtests: pytest.Subtests) -> None:
    for term in ["quux", "V*", "V^-1*", "__import__('os')", "V**2", "1", "", "V+w", "V^999"]:
        with subtests.test(term=term):
            settings = make_settings({"basis": "custom", "terms": {"lon": [term]}})
            with pytest.raises(SettingsError, match="term"):
                settings.bases()


def test_custom_basis_without_terms_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"custom.*\[terms\]"):
        make_settings({"basis": "custom"}).bases()


def test_third_partys_basis_is_learned_by_its_terms_alone() -> None:
    """A robot that slips sideways as no shipped basis knows: the terms in the settings are enough."""
    terms = {"lon": ["V"], "lat": ["V^2*w"], "ang": ["w", "V^2*w"]}
    truth = _core.Basis("toy", terms["lon"], terms["lat"], terms["ang"])
    alpha = (-0.1, 0.08, -0.3, 0.05)
    log = simulated_log(Drive(seconds=120.0, basis=truth, alpha=alpha))
    settings = make_settings({"basis": "custom", "terms": terms, "learn_clock_offset": False})
    model = calibrate(log, input="wheel", settings=settings).model
    sigma = np.sqrt(np.diag(model.covariance))
    slip = slice(len(alpha))
    assert (np.abs(model.mean[slip] - alpha) < 3.0 * sigma[slip]).all()
    assert (sigma[slip] < 0.1 * np.array([p.prior_std for p in model.content.parameters[slip]])).all()
    averaged = make_settings({"terms": terms, "auto": {"bases": ["none", "edd-2", "custom"]}})
    weights = calibrate(log, input="wheel", settings=averaged).model.content.weights
    assert weights["custom"] > 0.9


def test_keys_of_the_version_before_are_read_and_said() -> None:
    old = {"mount": {"x": 0.3}, "window": {"length": 1.9}, "prior": {"lag": 0.2}, "vehicle": {"track": 0.5}}
    with pytest.warns(OlderNames, match=r"mount is sensor_extrinsics now, window is segment now"):
        settings = make_settings(old)
    assert settings.sensor_extrinsics.x == 0.3
    assert settings.segment_length("wheel") == 1.9
    assert settings.prior.time_constant == 0.2
    assert settings.wheel_separation == 0.5


def test_older_keys_of_live_are_read_where_name_was_that_of_the_node() -> None:
    old = {"vehicle": "husky-1", "name": "front", "terrain": "sand", "memory": "monday.yaml"}
    with pytest.warns(OlderNames, match=r"live.vehicle is live.name now, live.name is live.node now"):
        live = make_settings({"live": old}).live
    assert (live.name, live.node, live.surface) == ("husky-1", "front", "sand")
    assert (live.memory, live.model) == (True, "monday.yaml")
    with pytest.raises(SettingsError, match=r"live.memory"):
        make_settings({"live": {"memory": "monday.yaml", "model": "another.yaml"}})
