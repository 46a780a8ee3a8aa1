# SPDX-License-Identifier: Apache-2.0
"""The contract of the Python layers refuses an upward import and a package that has no layer."""

import shutil
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path

from tools.requirements import ROOT

LICENCE = "# SPDX-License-Identifier: Apache-2.0\n"


def lint(root: Path, modules: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Run the repository's contract over a package `slipwise` that holds `modules` (name -> source)."""
    package = root / "slipwise"
    for beside in ("slipwise_sim", "slipwise_thesis"):
        (root / beside).mkdir()
        (root / beside / "__init__.py").write_text(LICENCE, encoding="utf-8")
    package.mkdir()
    for name in ("__init__", "errors", "files", *modules):
        (package / f"{name}.py").write_text(LICENCE + modules.get(name, ""), encoding="utf-8")
    shutil.copy(ROOT / "pyproject.toml", root)
    # Without site (-S) no editable installation stands before the package here.
    paths = [str(root), sysconfig.get_path("purelib"), sysconfig.get_path("platlib")]
    code = f"import sys; sys.path[:0] = {paths}; from importlinter.cli import lint_imports_command as f; f()"
    command = [sys.executable, "-S", "-c", code, "--no-cache"]
    return subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)


def test_an_upward_import_breaks_the_contract(tmp_path: Path) -> None:
    result = lint(tmp_path, {"logs": "", "cli": "import slipwise.logs\n", "files": "import slipwise.cli\n"})
    assert result.returncode == 1
    assert "slipwise.files is not allowed to import slipwise.cli" in result.stdout


def test_a_downward_import_keeps_it(tmp_path: Path) -> None:
    result = lint(tmp_path, {"logs": "import slipwise.files\n", "cli": "import slipwise.logs\n"})
    assert result.returncode == 0, result.stdout


def test_a_package_without_a_layer_breaks_the_contract(tmp_path: Path) -> None:
    result = lint(tmp_path, {"without_layer": ""})
    assert result.returncode == 1
    assert "without_layer" in result.stdout


def test_every_part_of_the_package_has_a_layer() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contract = project["tool"]["importlinter"]["contracts"][0]
    layers = {layer.strip("()") for layer in contract["layers"]}
    known = layers | set(contract["exhaustive_ignores"]) | {"__init__", "__pycache__"}
    parts = [path for path in (ROOT / "python/slipwise").iterdir() if path.suffix == ".py" or path.is_dir()]
    assert {path.stem for path in parts} <= known
