# SPDX-License-Identifier: Apache-2.0
"""A learned motion model: saved as one YAML file, read back strictly, ready for prediction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from slipwise import _core
from slipwise.argument_types import check_arguments
from slipwise.errors import ModelError
from slipwise.files import write_text_whole
from slipwise.frames import data_frame
from slipwise.lazy_names import no_attribute
from slipwise.models.car import car_of
from slipwise.models.consistent_content import check_content
from slipwise.models.file_text import file_text
from slipwise.models.inputs import MANY, InputName, input_name_of
from slipwise.models.limits import LimitsSection, core_limits, limits_of
from slipwise.models.parameter_table import VECTOR, ParameterTable, PhysicalParameter, physical_parameters
from slipwise.models.schema import SCHEMA_VERSION, ModelFile, VerdictSection
from slipwise.models.upgrade import READ_VERSIONS, upgraded, with_delay
from slipwise.models.yaml_file import parse_yaml, read_yaml
from slipwise.validation_text import first_problem

if TYPE_CHECKING:
    import pandas as pd


LOGS = (".csv", ".parquet", ".mcap", ".db3", ".bag")  # what names of logs mostly end in
_HINTS = {
    "predict": "slipwise.predict(model, commands, horizon=5.0)",
    "evaluate": "slipwise.evaluate(log, model=model)",
    "rollout": "slipwise.planning.rollout(model, commands, dt)",
    "export": "slipwise.export_model",
    "summary": "slipwise.summarise(model)",
    "params": "model.parameters",
    "load": "slipwise.load_model(path)",
}


@dataclass(frozen=True)
class Model:
    """The only thing that crosses from learning to using.

    Raises:
        ModelError: the content contradicts itself (terms, names, a covariance that is none).
    """

    content: ModelFile

    def __post_init__(self) -> None:
        check_content(self)

    def __repr__(self) -> str:
        from slipwise.models.summary import summarise

        content = self.content
        inputs = " and ".join(f"{name}s" for name in self.inputs)
        head = f"{content.slip.basis} from {inputs}, {len(content.parameters)} parameters"
        return f"<Model: {head}. {summarise(self).sentences[0]}>"

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(no_attribute("a Model", name, _HINTS), name=name, obj=self)

    def _repr_html_(self) -> str:
        """What a notebook shows: the summary, and the parameters in physical units."""
        from slipwise.models.summary import model_html

        return model_html(self)

    def __reduce__(self) -> tuple[type[Model], tuple[ModelFile]]:
        """Pickle the content alone: what the core has made of it is made again."""
        return Model, (self.content,)

    def __getitem__(self, name: str) -> PhysicalParameter:
        """Return a parameter or limit by its physical name, such as `delay_v`: `.value`, `.std`, `.unit`.

        Raises:
            ModelError: the model has no such parameter.
        """
        found = self.parameters.get(name)
        if found is None:
            raise ModelError(
                f"the model has no parameter {name!r}", advice=f"it has {', '.join(self.parameters)}"
            )
        return found

    def __contains__(self, name: object) -> bool:
        return name in self.parameters

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    @property
    def verdict(self) -> VerdictSection:
        """Whether the model may be used, in words: `.good`, `.sentence`, `.advice`."""
        return self.content.verdict

    @cached_property
    def parameters(self) -> dict[str, PhysicalParameter]:
        """All that was learned in physical units, by name."""
        return {parameter.name: parameter for parameter in physical_parameters(self)}

    def to_dataframe(self) -> pd.DataFrame:
        """Return name, value, std, unit and identified of every parameter and limit, one a row.

        Raises:
            SlipwiseError: pandas is not installed.
        """
        rows = list(self.parameters.values())
        names = ("name", "value", "std", "unit", "identified")
        return data_frame({name: [getattr(row, name) for row in rows] for name in names})

    @property
    def inputs(self) -> tuple[InputName, ...]:
        """What the model answers from, the input first that is meant where none is named."""
        other = self.content.other_input
        return (self.content.input,) if other is None else (self.content.input, other.input)

    @property
    def steers(self) -> bool:
        """Whether the robot is known to be commanded by speed and steering angle."""
        return any(self.of_input(name).content.wheelbase is not None for name in self.inputs)

    @cached_property
    def _other(self) -> Model | None:
        other = self.content.other_input
        return None if other is None else Model(other)

    @property
    def alone(self) -> Model:
        """The same without its other input."""
        if self.content.other_input is None:
            return self
        return Model(self.content.model_copy(update={"other_input": None}))

    def of_input(self, name: str | None = None) -> Model:
        """Return the model that answers from one input, "command" or "wheel"; itself where none is named.

        Raises:
            ModelError: nothing was learned from this input.
            SettingsError: there is no such input.
        """
        asked = self.content.input if name is None else input_name_of(name)
        if asked == self.content.input:
            return self
        if self._other is None:
            raise ModelError(
                f"the model was learned from {MANY[self.content.input]}, and nothing from {MANY[asked]}",
                advice=f"give it {MANY[self.content.input]}, or calibrate a log that has {MANY[asked]}",
            )
        return self._other

    @cached_property
    def motion(self) -> _core.MotionModel:
        """The motion model of the core."""
        slip = self.content.slip
        try:
            basis = _core.Basis(slip.basis, slip.lon, slip.lat, slip.ang)
        except ValueError as problem:
            raise ModelError(str(problem), advice="calibrate again, or restore the file") from problem
        content = self.content
        if content.response:
            motion = _core.MotionModel.with_response(basis, content.clock_offset)
        elif content.delays:
            motion = _core.MotionModel.with_delays(basis)
        elif content.lags:
            motion = _core.MotionModel.with_lags(basis, content.clock_offset)
        else:
            motion = _core.MotionModel(basis, content.dynamics, content.clock_offset)
        return motion.with_extrinsics(content.sensor_extrinsics).with_wheelbase(content.wheelbase or 0.0)

    @cached_property
    def body(self) -> Model:
        """The model of base_link, by the clock of the inputs: without the pose sensor's place and clock.

        Where wheel speeds are stamped late, its delays are those to the motion, not to the wheel speeds.
        """
        if not (self.content.sensor_extrinsics or self.content.clock_offset):
            return self
        mean, covariance = self.motion.of_base_link(self.vector.values, self.vector.covariance)
        table = self.table.without("sensor", "clock").with_vector(mean, covariance)
        return self.with_table(table, sensor_extrinsics=False, clock_offset=False)

    @cached_property
    def table(self) -> ParameterTable:
        """All that was learned: one row a number, and one covariance."""
        rows = self.content.parameters
        covariance = np.array(self.content.covariance, dtype=np.float64).reshape(len(rows), len(rows))
        return ParameterTable(tuple(rows), covariance)

    @cached_property
    def vector(self) -> ParameterTable:
        """The rows that the core takes as one vector: without limits and curves."""
        return self.table.of(*VECTOR)

    def with_table(self, table: ParameterTable, **changes: object) -> Model:
        """Return the model with other rows, and other content."""
        return Model(self.content.model_copy(update={**table.content(), **changes}))

    @cached_property
    def limits_section(self) -> LimitsSection | None:
        """The limits in front of the actuator, by axis and kind, where some were learned."""
        return limits_of(self.content.parameters, self.content.limit_gains)

    @cached_property
    def limits(self) -> _core.CommandLimits | None:
        """The limits in front of the actuator, where some were learned."""
        section = self.limits_section
        return None if section is None else core_limits(section)

    @cached_property
    def car(self) -> _core.CarCurves | None:
        """What throttle and steering do, where these are the commands."""
        return car_of(self.content.parameters, self.table.covariance)

    def refuse_heading(self, what: str) -> None:
        """Refuse a use that knows no heading over the map where a force of the model depends on it.

        Raises:
            ModelError: it does.
        """
        if self.motion.basis.by_heading:
            raise ModelError(
                f"{what} know no heading over the map, and a force of this model depends on it",
                advice="use without_force(model), or calibrate with --set body_force.frame=body",
            )

    def refuse_throttle(self, what: str) -> None:
        """Refuse a use that takes speeds and yaw rates where the model takes throttle and steering.

        Raises:
            ModelError: it does.
        """
        if self.car is not None:
            raise ModelError(
                f"{what} need speeds and yaw rates, and this model takes throttle and steering",
                advice="predict() takes them; or calibrate from measured speeds, with --input wheel",
            )

    def driven(self, inputs: _core.InputHistory) -> _core.InputHistory:
        """Return what reaches the actuator of these inputs: what the drive's limits leave of them."""
        if self.limits is None:
            return inputs
        return _core.limited_inputs(inputs, self.limits, _core.RAMP_PIECE)

    def driven_from(
        self, inputs: _core.InputHistory, time: float, measured: _core.BodyTwist
    ) -> _core.InputHistory:
        """Return the same where the drive did `measured` at `time` [s], in the stamps of the inputs."""
        if self.limits is None:
            return inputs
        actuator = self.motion.actuator(self.mean)
        return _core.limited_inputs_from(inputs, self.limits, actuator, time, measured)

    @property
    def mean(self) -> NDArray[np.float64]:
        """Parameter values, [parameters], in SI units."""
        return self.vector.values.copy()

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of the parameters, [parameters, parameters]."""
        return self.vector.covariance.copy()

    @cached_property
    def noise(self) -> _core.MotionNoise:
        """Noise of slip rates and poses, before the learned scale."""
        noise = self.content.noise
        return _core.MotionNoise(
            noise.psd_time, noise.psd_motion, noise.fraction, noise.pose_std_xy, noise.pose_std_yaw
        )

    @property
    def prior_std(self) -> NDArray[np.float64]:
        """Standard deviations of the parameters before the log, [parameters]."""
        return np.array([row.prior_std for row in self.vector.rows], dtype=np.float64)

    @cached_property
    def posterior(self) -> _core.MotionPosterior:
        """What the core predicts from: parameters, how sure they are, and the noise."""
        estimate = _core.Estimate(self.mean, self.covariance)
        scale = np.array(self.content.noise.variance_scale)
        return _core.MotionPosterior(self.motion, estimate, self.prior_std, self.noise, scale)

    def posterior_after(self, seconds: float) -> _core.MotionPosterior:
        """The same some time later [s]: a force that was learned beside slip may have gone meanwhile."""
        section, now = self.content.body_force, self.posterior
        if section is None:
            return now
        law = _core.BodyForceSettings()
        law.time_constant = section.time_constant
        law.std = law.turn_std = section.std
        later = _core.BodyForce(self.motion.basis, law).passed(now.estimate, seconds)
        return _core.MotionPosterior(now.model, later, now.prior_std, now.noise, now.noise_scale)

    @cached_property
    def disturbance(self) -> _core.DisturbanceModel:
        """The slip disturbance about the parameters; without any candidate where that was not learned."""
        disturbance = self.content.slip_disturbance
        candidates = [] if disturbance is None else disturbance.candidates
        return _core.DisturbanceModel(
            [_core.SlipDisturbance(each.linear, each.angular, each.time_constant) for each in candidates],
            np.array([each.weight for each in candidates], dtype=np.float64),
        )

    def covariance_over(self, seconds: float) -> NDArray[np.float64]:
        """Covariance of the parameters' mean over `seconds`, the slip disturbance included.

        Nothing recent is known of that slip (derivations/uncertainty.md). [parameters, parameters].
        """
        covariance = _core.covariance_over(
            self.motion, self.covariance, self.disturbance, self.prior_std, seconds
        )
        return np.asarray(covariance, dtype=np.float64)

    def save(self, path: str | Path) -> Path:
        """Write the model file, whole or not at all; return its path.

        Raises:
            OutputError: the file cannot be written.
            SettingsError: this is no path.
        """
        check_arguments(Model.save, locals())
        target = Path(path)
        write_text_whole(target, self.to_yaml())
        return target

    def to_yaml(self) -> str:
        """Return the text of the model file."""
        return file_text(self.content)


def load_model(path: str | Path, *, input: str | None = None) -> Model:
    """Read a model file.

    Args:
        path: of the file.
        input: "command" or "wheel", where the model answers from both; by default the one it is meant for.

    Raises:
        ModelError: the file is missing, not plain YAML, does not fit this schema version, or knows nothing
            of this input.
        SettingsError: there is no such input.
    """
    check_arguments(load_model, locals())
    if Path(path).suffix in LOGS:
        raise ModelError(
            "a log, not a model",
            where=str(path),
            advice=f"`slipwise calibrate {path} -o model.yaml` learns one",
        )
    return _model_of(read_yaml(Path(path)), str(path)).of_input(input)


def parse_model(text: str, *, where: str) -> Model:
    """Read the text of a model file that came from `where`, such as a topic.

    Raises:
        ModelError: the text is not plain YAML, or does not fit this schema version.
    """
    return _model_of(parse_yaml(text, where=where), where)


def _model_of(content: dict[str, Any], where: str) -> Model:
    version = content.get("slipwise_model")
    if isinstance(version, bool) or version not in READ_VERSIONS:
        known = f"{', '.join(map(str, READ_VERSIONS[:-1]))} and {READ_VERSIONS[-1]}"
        raise ModelError(
            f"the file has schema version {version!r}, this slipwise reads {known}",
            where=where,
            advice="is it a slipwise model? calibrate again, or use the slipwise version that wrote it",
        )
    try:
        read = with_delay(content if version == SCHEMA_VERSION else upgraded(content))
        return Model(ModelFile.model_validate(read))
    except ValidationError as problem:
        raise ModelError(
            first_problem(problem), where=where, advice="calibrate again, or restore the file"
        ) from problem
    except ModelError as problem:
        raise ModelError(problem.what, where=where, advice=problem.advice) from problem
