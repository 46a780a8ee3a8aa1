# SPDX-License-Identifier: Apache-2.0
"""The surfaces of two models of one robot in one."""

from __future__ import annotations

import pytest
from sample_surfaces import FIRM, model_of_floors

from slipwise.calibration.merge_surfaces import merge_surfaces
from slipwise.errors import ModelError
from slipwise.models import Model


def test_models_of_other_robots_are_refused() -> None:
    model = model_of_floors(FIRM)
    content = model.content
    command = content.model_copy(update={"input": "command"})
    with pytest.raises(ModelError, match="of wheels and the other of commands"):
        merge_surfaces(model, Model(command))
    settings = content.provenance.model_copy(update={"settings": {"vehicle": {"wheel_separation": 2.0}}})
    with pytest.raises(ModelError, match=r"other settings of \[vehicle\]"):
        merge_surfaces(model, Model(content.model_copy(update={"provenance": settings})))
    with pytest.raises(ModelError, match="remembers no surfaces"):
        merge_surfaces(model, Model(content.model_copy(update={"surfaces": []})))
