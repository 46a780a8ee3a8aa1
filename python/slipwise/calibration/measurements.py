# SPDX-License-Identifier: Apache-2.0
"""What a learner takes: commands, wheels, poses and positions of its sources, a gyro, attitudes, forces."""

from __future__ import annotations

from slipwise import _core
from slipwise.calibration.core_settings import car_of
from slipwise.calibration.inputs_seen import SidewaysSeen, WheelStep
from slipwise.calibration.settings import Settings
from slipwise.errors import SettingsError
from slipwise.logs.attitude import mounting_words
from slipwise.logs.fixes import fix_number
from slipwise.logs.gyro import COLUMN as GYRO
from slipwise.logs.readings import READINGS
from slipwise.models.axes import SIDEWAYS, THROTTLE, TWIST, Axes


class Measurements:
    """The measurements of a `MotionLearner`."""

    _core: _core.MotionLearner
    _positions: bool
    _input: str
    _settings: Settings
    _wheels: bool
    _wheel_step: WheelStep
    _sideways: dict[str, SidewaysSeen]  # of each input
    _gyro_alone: bool
    _sources: dict[str, int]  # of poses, by name

    @property
    def axes(self) -> Axes:
        """The numbers of its inputs, and of the rows that `predict` takes."""
        if car_of(self._settings) is not None:
            return THROTTLE
        return TWIST if self._sideways[self._input].span is None else SIDEWAYS

    @property
    def positions(self) -> bool:
        """Whether it learns from positions, and not from poses."""
        return self._positions

    @property
    def gyro_alone(self) -> bool:
        """Whether it learns from turns of a gyro alone."""
        return self._gyro_alone

    @property
    def tells_sources(self) -> bool:
        """Whether it tells sources of poses, or their fixes, apart."""
        return bool(self._sources)

    def knows_source(self, source: str) -> bool:
        """Say whether it expects poses of a source; one without a name is the first."""
        return not source or source in self._sources

    def is_first(self, source: str) -> bool:
        """Say whether a source of poses is the first; so is one without a name."""
        return not source or self._sources.get(source) == 0

    def push_command(self, t: float, v: float, omega: float, vy: float = 0.0) -> None:
        """Take a command: its stamp [s], speeds [m/s] and yaw rate [rad/s].

        Of a car commanded by throttle and steering (`vehicle` of [log]) v is the throttle and omega the
        steering, both in [-1, 1].
        """
        self._sideways["command"].take(v, vy)
        self._core.push_command(t, v, omega, vy)

    def push_wheels(self, t: float, v: float, omega: float, vy: float = 0.0) -> None:
        """Take the twist that the wheels measure: its stamp [s], speeds [m/s] and yaw rate [rad/s]."""
        self._wheels = True
        self._wheel_step.take(t)
        self._sideways["wheel"].take(v, vy)
        self._core.push_wheels(t, v, omega, vy)

    def push_pose(  # noqa: PLR0913 (a measurement has as many numbers)
        self,
        t: float,
        x: float,
        y: float,
        yaw: float,
        std_xy: float | None = None,
        std_yaw: float | None = None,
        frame: int = 0,
        *,
        learned: bool = True,
        source: str = "",
        fix: str = "",
    ) -> None:
        """Take a measured pose: its stamp [s], x, y [m], yaw [rad]; comparable in one frame alone.

        Args:
            t: stamp [s].
            x: position [m].
            y: position [m].
            yaw: heading [rad].
            std_xy: standard deviation of x and of y [m], where the sensor says it: how much this pose counts
                beside others. How large errors are on the whole is learned.
            std_yaw: the same of the heading [rad].
            frame: poses of different frames are not compared.
            learned: whether slip may be learned from it; else it serves odometry alone, and nothing is
                joined across it.
            source: that measured it, of those that the learner was made with; the first by default.
            fix: what a satellite receiver says of it, such as "rtk_fixed" (`logs.fixes`).

        Raises:
            SettingsError: there is no such source.
            LogError: there is no such fix.
        """
        self._core.push_pose(
            t, x, y, yaw, frame, std_xy or 0.0, std_yaw or 0.0, learned, *self._source(source, fix)
        )

    def push_position(  # noqa: PLR0913 (a measurement has as many numbers)
        self,
        t: float,
        x: float,
        y: float,
        std_xy: float | None = None,
        frame: int = 0,
        *,
        learned: bool = True,
        source: str = "",
        fix: str = "",
    ) -> None:
        """Take a measured position without a heading, such as that of a GNSS antenna.

        Args:
            t: stamp [s].
            x: position [m].
            y: position [m].
            std_xy: standard deviation of x and of y [m], where the sensor says it.
            frame: positions of different frames are not compared.
            learned: whether slip may be learned from it; else nothing is joined across it.
            source: that measured it, of those that the learner was made with; the first by default.
            fix: what a satellite receiver says of it, such as "rtk_fixed" (`logs.fixes`).

        Raises:
            SettingsError: the first source was said to measure poses, or there is no such source.
            LogError: there is no such fix.
        """
        number = self._source(source, fix)
        if not self._positions and number[0] == 0:
            raise SettingsError("this learner expects poses", advice="make it with Coming(positions=True)")
        self._core.push_position(t, x, y, frame, std_xy or 0.0, learned, *number)

    def push_gyro(self, t: float, rate: float) -> None:
        """Take a yaw rate [rad/s], counter-clockwise, at a stamp [s]: turns between positions are its own."""
        self.push_reading(t, GYRO, rate)

    def push_reading(self, t: float, column: str, value: float) -> None:
        """Take what a sensor of one number measured at a stamp [s].

        Args:
            t: stamp [s].
            column: of a tidy log that holds its numbers, such as gyro_z.
            value: in the unit of that column.

        Raises:
            SettingsError: no such sensor is learned from.
        """
        if all(column != kind.column for kind in READINGS):
            known = ", ".join(kind.column for kind in READINGS)
            raise SettingsError(f"no sensor of one number has a column {column}", advice=f"known are {known}")
        self._core.push_reading(t, column, value)

    def push_force(self, t: float, x: float, y: float) -> None:
        """Take a known force over the mass from a stamp [s] on: along the x axis and to the left [m/s^2].

        It holds until the next one, and pushes as gravity on a slope; beside roll and pitch it is rejected.
        """
        self._core.push_force(t, x, y)

    def push_attitude(self, t: float, roll: float, pitch: float) -> None:
        """Take roll and pitch [rad] at a stamp [s]; by REP-103 nose down is positive pitch."""
        self._core.push_attitude(t, roll, pitch)

    @property
    def attitude_mounting(self) -> str:
        """How the sensor of roll and pitch is mounted, where it is not level, and what is done about that."""
        return mounting_words(self._core.attitude_mounting)

    def _source(self, name: str, fix: str) -> tuple[int, int]:
        """Return the numbers of a source and of a fix.

        Raises:
            SettingsError: the learner knows none of that name, or tells no fixes apart.
            LogError: there is no such fix.
        """
        if fix and not self._sources:
            raise SettingsError(
                "this learner tells no fixes apart", advice="make it with Coming(sources=...)"
            )
        try:
            number = self._sources[name] if name else 0
        except KeyError:
            known = ", ".join(self._sources) or "none: make it with Coming(sources=...)"
            raise SettingsError(f"unknown source of poses '{name}'", advice=f"known are {known}") from None
        return number, fix_number(fix)
