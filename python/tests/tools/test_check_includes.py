# SPDX-License-Identifier: Apache-2.0
"""The layer checker of the C++ core finds what breaks the layers, and accepts the core as it is."""

from pathlib import Path

import pytest
from tools.check_includes import LAYERS, ROOT, check, cycles


def write(root: Path, path: str, *lines: str) -> None:
    """Write a C++ file of `lines` at `path` below `root`."""
    file = root / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("\n".join(("// SPDX-License-Identifier: Apache-2.0", *lines, "")), encoding="utf-8")


def test_the_core_keeps_its_layers() -> None:
    assert (ROOT / "cpp/include/slipwise/lie/se2.hpp").exists()
    assert check(ROOT) == []


def test_lower_layers_standard_headers_and_eigen_are_accepted(tmp_path: Path) -> None:
    write(tmp_path, "cpp/include/slipwise/lie/se2.hpp", "#include <cmath>", "#include <Eigen/Core>")
    write(
        tmp_path,
        "cpp/src/motion/model.cpp",
        '#include "slipwise/lie/se2.hpp"',
        '#include "slipwise/slip/term.hpp"',
    )
    assert check(tmp_path) == []


def test_a_source_includes_its_own_header_first(tmp_path: Path) -> None:
    write(tmp_path, "cpp/include/slipwise/lie/se2.hpp", "#include <cmath>")
    write(tmp_path, "cpp/src/lie/se2.cpp", "#include <vector>", '#include "slipwise/lie/se2.hpp"')
    write(tmp_path, "cpp/src/lie/other.cpp", "#include <vector>", '#include "slipwise/lie/se2.hpp"')
    assert check(tmp_path) == [
        "cpp/src/lie/se2.cpp:2: includes vector before its own header, slipwise/lie/se2.hpp"
    ]


def test_a_source_includes_what_has_its_types_and_constants(tmp_path: Path) -> None:
    declared = ("inline constexpr double kStep = 0.1;", "struct Path {", "};", "using Steps = int;")
    write(tmp_path, "cpp/include/slipwise/lie/path.hpp", *declared)
    write(tmp_path, "cpp/src/motion/all.cpp", '#include "slipwise/lie/path.hpp"', "Path p{kStep, Steps{1}};")
    write(tmp_path, "cpp/src/motion/own.cpp", "constexpr double kStep = 0.2;", "double s = kStep;")
    assert check(tmp_path) == []
    write(tmp_path, "cpp/src/motion/none.cpp", "#include <cmath>", "Path p{kStep};  // Steps")
    assert check(tmp_path) == [
        f"cpp/src/motion/none.cpp: {name} without slipwise/lie/path.hpp" for name in ("Path", "kStep")
    ]


@pytest.mark.parametrize("folder", [folder for row in LAYERS[:-1] for folder in row])
def test_a_header_of_a_higher_layer_is_refused(tmp_path: Path, folder: str) -> None:
    write(
        tmp_path,
        f"cpp/include/slipwise/{folder}/here.hpp",
        "#pragma once",
        '#include "slipwise/thesis/there.hpp"',
    )
    (fault,) = check(tmp_path)
    assert fault.startswith(f"cpp/include/slipwise/{folder}/here.hpp:3: '{folder}' must not include")


@pytest.mark.parametrize(
    ("here", "there"),
    [("slip", "vehicle"), ("vehicle", "actuator"), ("rollout", "segment"), ("segment", "rollout")],
)
def test_siblings_do_not_know_each_other(tmp_path: Path, here: str, there: str) -> None:
    write(tmp_path, f"cpp/src/{here}/one.cpp", f'#include "slipwise/{there}/two.hpp"')
    (fault,) = check(tmp_path)
    assert f"'{there}' is not below it" in fault


@pytest.mark.parametrize(
    "line",
    [
        "#include <boost/math/constants/constants.hpp>",
        "#include <nanobind/nanobind.h>",
        "#include <string.h>",
        '#include "se2.hpp"',
        '#  include "../lie/se2.hpp"',
    ],
)
def test_a_header_that_is_neither_ours_nor_standard_nor_eigen_is_refused(tmp_path: Path, line: str) -> None:
    write(tmp_path, "cpp/src/lie/angle.cpp", line)
    (fault,) = check(tmp_path)
    assert "the core uses the standard library, Eigen" in fault


def test_cuda_stands_in_cu_files_alone(tmp_path: Path) -> None:
    write(tmp_path, "cpp/src/rollout/device.cu", "#include <cuda_runtime.h>", "#include <string>")
    assert check(tmp_path) == []
    write(tmp_path, "cpp/src/rollout/device.cpp", "#include <cuda_runtime.h>")
    (fault,) = check(tmp_path)
    assert fault.startswith("cpp/src/rollout/device.cpp:2: includes cuda_runtime.h")


def test_a_folder_that_is_no_layer_is_refused(tmp_path: Path) -> None:
    write(tmp_path, "cpp/src/extras/one.cpp", "#include <cmath>")
    (fault,) = check(tmp_path)
    assert "'extras' is not a layer" in fault


def test_a_file_without_a_layer_is_refused_as_a_target(tmp_path: Path) -> None:
    write(tmp_path, "cpp/src/lie/one.cpp", '#include "slipwise/everything.hpp"')
    (fault,) = check(tmp_path)
    assert "is in no layer" in fault


def test_headers_that_include_each_other_are_found(tmp_path: Path) -> None:
    write(tmp_path, "cpp/include/slipwise/lie/one.hpp", '#include "slipwise/lie/two.hpp"')
    write(tmp_path, "cpp/include/slipwise/lie/two.hpp", '#include "slipwise/lie/three.hpp"')
    write(tmp_path, "cpp/include/slipwise/lie/three.hpp", '#include "slipwise/lie/one.hpp"')
    (fault,) = check(tmp_path)
    assert fault.startswith("headers include each other: ")
    assert fault.count(".hpp") == 4


def test_a_header_that_includes_itself_is_a_cycle() -> None:
    assert cycles({"one.hpp": {"one.hpp"}}) == ["headers include each other: one.hpp <- one.hpp"]


def test_a_header_that_is_included_twice_is_found(tmp_path: Path) -> None:
    write(tmp_path, "cpp/src/lie/one.cpp", "#include <cmath>", "#include <cmath>")
    assert check(tmp_path) == ["cpp/src/lie/one.cpp:3: includes cmath twice"]


def test_names_of_the_standard_library_come_from_headers_that_are_included(tmp_path: Path) -> None:
    write(tmp_path, "cpp/include/slipwise/lie/row.hpp", "#include <span>", "using Row = std::span<double>;")
    use = ("std::span<double> row;  // std::deque", 'auto text = "std::vector";', "Eigen::Vector2d v;")
    write(tmp_path, "cpp/src/lie/one.cpp", '#include "slipwise/lie/row.hpp"', *use)
    write(tmp_path, "cpp/src/lie/two.cpp", "#include <Eigen/Core>", "std::domain_error(std::max());", *use)
    assert check(tmp_path) == [
        "cpp/src/lie/one.cpp: Eigen:: without a header of Eigen",
        "cpp/src/lie/two.cpp: std::max without <algorithm>",
        "cpp/src/lie/two.cpp: std::span without <span>",
        "cpp/src/lie/two.cpp: std::domain_error without <stdexcept>",
    ]
