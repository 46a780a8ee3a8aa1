# SPDX-License-Identifier: Apache-2.0
"""What a log tells of sensors beside the first source of poses, put into its model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.calibration.gyro_clock import GyroClock, gyro_clock
from slipwise.calibration.learned import Learned
from slipwise.calibration.mounts import Mount, mounts_of
from slipwise.calibration.settings import Settings
from slipwise.logs.log import Log
from slipwise.models.parameter_table import ParameterTable
from slipwise.models.schema import ModelFile


@dataclass(frozen=True)
class FurtherSensors:
    """Mounts of further sources of poses, and the clock of a gyro beside poses with headings."""

    mounts: tuple[Mount, ...] = ()
    gyro: GyroClock | None = None

    def sentences(self) -> list[str]:
        """Say what a drive tells of them."""
        said = [mount.sentence() for mount in self.mounts]
        return [*said, *((self.gyro.sentence(),) if self.gyro is not None and self.gyro.sentence() else ())]

    def into(self, content: ModelFile) -> ModelFile:
        """Return the content of a model file with what is known of them as rows of its table."""
        covariance = np.array(content.covariance).reshape((len(content.parameters),) * 2)
        table = ParameterTable(tuple(content.parameters), covariance)
        for each in (*self.mounts, *((self.gyro,) if self.gyro is not None else ())):
            rows, among = each.rows()
            if rows and not {row.name for row in rows} & set(table.names):
                table = table.beside(rows, among)
        return content.model_copy(update=table.content())


def further_sensors(learned: Learned, log: Log, settings: Settings) -> FurtherSensors:
    """Return what a log tells of the sensors beside its first source."""
    mounts = mounts_of(log.runs, settings.sensor_extrinsics.pose) if learned.sources else ()
    return FurtherSensors(mounts, gyro_clock(log.runs))
