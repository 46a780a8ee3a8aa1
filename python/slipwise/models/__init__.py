# SPDX-License-Identifier: Apache-2.0
"""The model file and the model read from it."""

from slipwise.models.model import Model, load_model, parse_model
from slipwise.models.on_surface import on_surface
from slipwise.models.schema import SCHEMA_VERSION, ModelFile

__all__ = ["SCHEMA_VERSION", "Model", "ModelFile", "load_model", "on_surface", "parse_model"]
