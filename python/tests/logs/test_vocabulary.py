# SPDX-License-Identifier: Apache-2.0
"""The schema file says type, unit and meaning of each column, and covers what tables are written with."""

from __future__ import annotations

from sample_logs import Drive, simulated_log

from slipwise.logs.vocabulary import BY_NAME, table_schema
from slipwise.logs.write_tidy import tidy_table


def test_every_column_of_a_written_table_is_known() -> None:
    table = tidy_table(simulated_log(Drive(seconds=2.0)))
    kinds = {"string": "string", "number": "double", "integer": "int64"}
    assert {name: kinds[BY_NAME[name].type] for name in table.column_names} == {
        field.name: str(field.type) for field in table.schema
    }


def test_fields_have_units_and_the_order_of_the_table() -> None:
    schema = table_schema(["run", "t", "gyro_z", "terrain"], ["t", "gyro_z"])
    assert [field["name"] for field in schema["fields"]] == ["run", "t", "gyro_z", "terrain"]
    assert [field["type"] for field in schema["fields"]] == ["string", "number", "number", "string"]
    assert schema["fields"][1]["unit"] == "s"
    assert schema["fields"][1]["constraints"] == {"required": True}
    assert schema["primaryKey"] == ["run", "t"]
