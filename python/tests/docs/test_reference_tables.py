# SPDX-License-Identifier: Apache-2.0
"""Tables in the documents say what the code says: settings, bases, columns, names."""

import re
import runpy
import tomllib
import warnings

from python.tests.docs.pages import ROOT, blocks, code_words, table_rows

from slipwise import _core, student
from slipwise.calibration import consistency, identifiability, judgement, statistics
from slipwise.calibration.learning_tables import SEGMENT_SECONDS
from slipwise.calibration.settings import Settings, make_settings, user_settings
from slipwise.errors import OlderNames
from slipwise.evaluation.prediction_file import COLUMNS
from slipwise.evaluation.result import Score
from slipwise.logs.vocabulary import NUMERIC, TEXT
from slipwise.models.schema import ModelFile

DOCS = ROOT / "docs"


def read(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def read_derivations() -> str:
    """Return all pages of derivations one after the other."""
    return "\n".join(path.read_text(encoding="utf-8") for path in sorted((DOCS / "derivations").glob("*.md")))


def constants(file: str, *names: str) -> list[float]:
    """Return constants of a source of the core."""
    text = (ROOT / f"cpp/src/{file}.cpp").read_text(encoding="utf-8")
    found = [re.search(rf"\bk{name}(?: =|,) ([\d.]+)", text) for name in names]
    return [float(match[1]) for match in found if match is not None]


def test_the_settings_page_lists_every_key_with_its_default() -> None:
    page = read("settings.md")
    written = runpy.run_path(str(DOCS / "settings_page.py"))["with_rows"](page)
    assert written == page, "run python docs/settings_page.py"
    (block,) = blocks(DOCS / "settings.md", "toml")
    assert make_settings(tomllib.loads(block)) == Settings()
    defaults = re.search(r"default ([\d.]+) from wheel speeds, ([\d.]+) from commands", block)
    assert defaults is not None
    assert (float(defaults[1]), float(defaults[2])) == (SEGMENT_SECONDS["wheel"], SEGMENT_SECONDS["command"])


def test_the_troubleshooting_page_lists_every_check() -> None:
    page = read("troubleshooting.md")
    written = runpy.run_path(str(DOCS / "findings_page.py"))["with_rows"](page)
    assert written == page, "run python docs/findings_page.py"


def test_the_settings_blocks_of_other_pages_are_valid_and_without_older_keys() -> None:
    for page in sorted(DOCS.glob("*.md")):
        for block in blocks(page, "toml"):
            with warnings.catch_warnings():
                warnings.simplefilter("error", OlderNames)
                user_settings(tomllib.loads(block), where=page.name).bases()


def test_the_table_of_bases_has_the_terms_that_ship() -> None:
    rows = table_rows(read("choosing-a-model.md"), "| name | lon |")
    shown = {code_words(row[0])[0]: [code_words(cell) for cell in row[1:4]] for row in rows}
    assert set(shown) == {"none", *_core.basis_names()}
    shown["ipem-13"] = [shown["ipem-9"][i] + shown["ipem-13"][i][1:] for i in range(3)]
    shown["drive-9"] = [shown["drive-5"][i] + shown["drive-9"][i][1:] for i in range(3)]
    shown["odd-even-13"] = [shown["odd-even-10"][i] + shown["odd-even-13"][i][1:] for i in range(3)]
    shown["thesis-15"] = [shown["thesis-15"][0]] * 3
    for name in _core.basis_names():
        basis, written = _core.named_basis(name), _core.Basis(name, *shown[name])
        assert (basis.lon, basis.lat, basis.ang) == (written.lon, written.lat, written.ang), name


def test_number_in_a_name_of_a_basis_is_its_number_of_parameters() -> None:
    for name in _core.basis_names():
        assert int(name.rpartition("-")[2]) == _core.named_basis(name).size


def test_the_prediction_file_table_has_its_columns_in_order() -> None:
    rows = table_rows(
        read("statistics.md")[read("statistics.md").index("## The prediction file") :], "| column |"
    )
    shown = [name for row in rows for name in code_words(row[0])]
    assert shown == list(COLUMNS)


def test_every_score_is_explained() -> None:
    rows = table_rows(read("statistics.md"), "| on the screen | in JSON |")
    shown = [word for row in rows for word in code_words(row[1])]
    assert sorted(shown) == sorted(Score.__dataclass_fields__)


def test_every_tidy_column_is_explained() -> None:
    rows = table_rows(read("getting-started.md"), "| column | unit |")
    shown = {word for row in rows for cell in row for word in code_words(cell)}
    assert {*NUMERIC, *TEXT} - {"terrain"} <= shown


def test_every_key_of_the_model_file_is_explained() -> None:
    rows = table_rows(read("getting-started.md"), "| key | what |")
    shown = {word for row in rows for word in code_words(row[0])}
    assert shown == set(ModelFile.model_fields)


def test_names_in_the_notation_exist_in_the_code() -> None:
    folders = (ROOT / "cpp/include", ROOT / "cpp/src", ROOT / "python/slipwise", ROOT / "packages")
    sources = [p for folder in folders for p in folder.rglob("*") if p.suffix in (".hpp", ".cpp", ".py")]
    text = "\n".join(path.read_text(encoding="utf-8") for path in sources)
    words = [
        word for row in table_rows(read("notation.md"), "| symbol | code |") for word in code_words(row[1])
    ]
    names = {name for word in words for name in re.split(r"[.:\s]+", word)}
    assert len(names) > 50
    assert not {name for name in names if not re.search(rf"\b{re.escape(name)}\b", text)}


def test_the_readme_table_of_real_logs_has_its_columns() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    start, end = text.index("<!-- table: real logs -->"), text.index("<!-- end of table -->")
    header = text[start:end].splitlines()[1]
    assert [cell.strip() for cell in header.strip("|").split("|")] == [
        *("method", "wheel position", "wheel heading", "command position", "command heading", "worst log")
    ]


def test_constants_of_the_core_quoted_in_the_pages_are_right() -> None:
    derivations, settings = read_derivations(), " ".join(read("settings.md").split())
    header = (ROOT / "cpp/include/slipwise/motion/motion_noise.hpp").read_text(encoding="utf-8")
    turn, straight = (
        re.search(rf"{name}(?: =|,) ([\d.]+)", header) for name in ("kTurnRadius", "kStraightRadius")
    )
    assert turn is not None
    assert straight is not None
    assert f"{float(turn[1]):g} m per radian" in derivations
    assert f"{float(turn[1]):g} m per radian" in settings
    assert f"over {float(straight[1]):g} m" in derivations
    noise, average, iekf = _core.NoiseSettings(), _core.ModelAverageSettings(), _core.IekfSettings()
    assert f"max(1/(n + {noise.prior_segments:g}), 1/{noise.forgetting_time:g})" in derivations
    assert f"{noise.largest:g} s_i" in derivations
    weighting = average.weighting
    assert f"η = {weighting.learning_rate:g}, fraction α_n = min({weighting.fraction:g}, 1/n)" in derivations
    assert f"has π = {average.largest_basis:g}" in derivations
    assert f"Above {iekf.gate:g} the window is left out. Above {iekf.huber:g}²" in derivations
    assert f"by less than {iekf.tolerance:g}" in derivations


def test_constants_of_judging_quoted_in_the_pages_are_right() -> None:
    derivations = read_derivations()
    flowing = " ".join(derivations.split())
    scale_std, dof, dof_std = constants(
        "online/student_calibration", "PriorScaleStd", "PriorDof", "PriorDofStd"
    )
    assert f"ln c normal about ln 1 with standard deviation {scale_std:g}" in flowing
    assert f"ln ν about ln {dof:g} with {dof_std:g}" in flowing
    assert f"ν lies between {student.LEAST_DOF:g} and {student.MOST_DOF:g}" in flowing
    prior = _core.StudentCalibration().fitted()
    assert f"with no window at all, ν is about {prior.dof:.1f}" in flowing
    limits = f"prior: inflation {prior.inflation:.1f}, dof {prior.dof:.1f}"
    assert limits in " ".join(read("statistics.md").split())
    assert f"{student.ellipse_squared(0.95, 10.0):.1f} for 95 % and dof = 10" in " ".join(
        read("statistics.md").split()
    )
    assert f"from {statistics.RESAMPLES} samples of moving blocks" in derivations
    assert f"not identifiable above a ratio of {identifiability.UNIDENTIFIABLE_RATIO:g}" in " ".join(
        derivations.split()
    )
    pages = " ".join(read("statistics.md").split())
    assert f"with a ratio up to {judgement.SAME:g} counting as the same" in pages
    assert f"hold fewer than {100 * consistency.LEAST_INSIDE:.0f} % of the segments" in pages
    assert f"or the 50 % ellipsoids more than {100 * consistency.MOST_INSIDE:.0f} %" in pages
    assert consistency.FAR == 3.0
    assert "beyond three times the end of its band" in pages
    assert f"fewer than {judgement.FEWEST_WINDOWS} held-out segments" in read("getting-started.md")
    assert statistics.BLOCK_WINDOWS == 3, "the pages say blocks of three windows"
    points = ", ".join(f"{point:.3f}" for point in statistics.ELLIPSOIDS.values())
    assert points.replace(", 7", " and 7") in derivations
