# SPDX-License-Identifier: Apache-2.0
"""Checks how large classes are: how many public methods, by name, and how many data members each has.

C++ is read by its layout, which clang-format keeps: what a class declares stands two columns inside it.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
HEADERS = ("cpp/include", "packages/slipwise-thesis/cpp/include")
MODULES = (
    "python/slipwise",
    "packages/slipwise-sim/slipwise_sim",
    "packages/slipwise-thesis/slipwise_thesis",
)

MOST_METHODS = 12
MOST_MEMBERS = 12
FEW_METHODS = 2
#: Larger classes by file, with how many public methods and members they have: they may shrink.
LARGER: dict[str, tuple[int, int]] = {
    "axis_stepper.hpp AxisStepper": (13, 4),
    "basis.hpp Basis": (13, 9),
    "branch_bank.hpp BranchBank": (17, 12),
    "car_curve_filter.hpp CarCurveFilter": (10, 13),
    "cascaded_model.hpp CascadedModel": (15, 15),
    "causal_filter.hpp CausalFilter": (20, 18),
    "filter_refit.hpp FilterRefit": (6, 16),
    "hypothesis_bank.hpp HypothesisWeights": (14, 4),
    "input_buffer.hpp InputBuffer": (22, 4),
    "land_tamer.py LandTamer": (3, 17),
    "lane_job.hpp LaneJob": (3, 32),
    "measured_drive.hpp MeasuredDrive": (16, 7),
    "measurements.py Measurements": (15, 9),
    "model.py Model": (29, 1),
    "model_average.hpp ModelAverage": (24, 8),
    "motion_evidence.hpp MotionEvidence": (17, 13),
    "motion_learner.hpp MotionLearner": (25, 5),
    "motion_learner.py MotionLearner": (20, 0),
    "motion_model.hpp MotionModel": (14, 4),
    "motion_monitor.hpp MotionMonitor": (3, 13),
    "motion_window.hpp WindowCutter": (7, 14),
    "predictions.py Predictions": (9, 14),
    "remembering_average.hpp RememberingAverage": (15, 5),
    "segment_learner.hpp SegmentLearner": (25, 12),
    "segment_stream.hpp SegmentStream": (18, 26),
    "settings.py Settings": (7, 17),
    "structures.hpp Structures": (18, 7),
    "surface_bank.hpp SurfaceBank": (15, 8),
    "surface_labels.hpp SurfaceLabels": (14, 3),
    "surface_list.hpp SurfaceList": (18, 5),
}

CLASS = re.compile(r"(class|struct) (?:alignas\(\S+\) )?(\w+)(?: final)?(?: : .*)? \{$")
OTHER = re.compile(r"(using|friend|enum|struct|class|template|static_assert|union|namespace)\b")


def declarations(lines: list[str]) -> Iterator[tuple[bool, str]]:
    """Yield what the body `lines` of a C++ class declares, with whether it is public."""
    public = True
    for i, line in enumerate(lines):
        if label := re.match(r" (public|private|protected):", line):
            public = label[1] == "public"
        elif re.match(r"  [^\s/}#]", line):
            text = line.strip()
            for more in lines[i + 1 :]:
                if re.search(r"[;{]$", text.split("//")[0].strip()) or not re.match(r"   ", more):
                    break
                text += " " + more.strip()
            yield public, text


def head_of(text: str) -> str:
    """Return what stands before the body or value of the declaration `text`, without template arguments."""
    return re.sub(r"<[^<>]*>", "", re.sub(r"<[^<>]*>", "", text)).split("{")[0].split(" = ")[0]


def name_of_method(head: str, owner: str) -> str | None:
    """Return the method that `head` declares in class `owner`; None for constructors, operators, members."""
    if "(" not in head or "operator" in head:
        return None
    name = head[: head.index("(")].rsplit(maxsplit=1)[-1].lstrip("*&")
    return None if name.lstrip("~") == owner else name


def cpp_classes(text: str) -> Iterator[tuple[str, int, int]]:
    """Yield name, public methods and members of each class in the header `text`."""
    lines = text.splitlines()
    for i, line in enumerate(lines):
        found = CLASS.match(line)
        if found is None:
            continue
        end = next(k for k in range(i, len(lines)) if lines[k].startswith("}"))
        body = [" public:" if found[1] == "struct" else " private:", *lines[i + 1 : end]]
        methods: set[str] = set()
        members = 0
        for public, declared in declarations(body):
            plain = re.sub(r"^template <.*?> ", "", declared)
            if OTHER.match(plain) or plain.startswith(("static constexpr", "inline constexpr")):
                continue
            head = head_of(plain)
            name = name_of_method(head, found[2])
            if name is not None and public:
                methods.add(name)
            members += "(" not in head and not plain.startswith("static ")
        yield found[2], len(methods), members


def python_classes(text: str) -> Iterator[tuple[str, int, int]]:
    """Yield name, public methods and annotated fields of each class in the module `text`."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ClassDef):
            methods = [part for part in node.body if isinstance(part, ast.FunctionDef | ast.AsyncFunctionDef)]
            fields = [part for part in node.body if isinstance(part, ast.AnnAssign)]
            yield node.name, sum(not part.name.startswith("_") for part in methods), len(fields)


def classes(root: Path) -> Iterator[tuple[str, str, int, int]]:
    """Yield path, name, public methods and members of each class below `root`."""
    for folders, suffix, read in ((HEADERS, "*.hpp", cpp_classes), (MODULES, "*.py", python_classes)):
        for folder in folders:
            for path in sorted((root / folder).rglob(suffix)):
                for name, methods, members in read(path.read_text(encoding="utf-8")):
                    yield path.relative_to(root).as_posix(), name, methods, members


def key_of(path: str, name: str) -> str:
    """Return what a class of the file at `path` is called in LARGER."""
    return f"{path.rsplit('/', 1)[-1]} {name}"


def faults_of(path: str, name: str, methods: int, members: int) -> list[str]:
    """Return what is wrong with the size of a class; data with few methods may have many members."""
    has = f"{path}: {name} has {methods} public methods and {members} members"
    large = methods > MOST_METHODS or (members > MOST_MEMBERS and methods > FEW_METHODS)
    most = LARGER.get(key_of(path, name))
    if most is None:
        limit = f"{MOST_METHODS} and {MOST_MEMBERS} are the limit"
        return [f"{has}; split it by concept, {limit}"] if large else []
    if (methods, members) == most and large:
        return []
    wrong = "larger" if methods > most[0] or members > most[1] else "smaller, which is to be written there"
    return [f"{has}, {most} in LARGER: it is {wrong}"]


def main(root: Path) -> int:
    """Print the faults; return 1 if there are any."""
    found = list(classes(root))
    faults = [fault for each in found for fault in faults_of(*each)]
    faults += [
        f"LARGER: there is no {key}"
        for key in LARGER.keys() - {key_of(path, name) for path, name, _, _ in found}
    ]
    print("\n".join(faults) if faults else "classes: no fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT))
