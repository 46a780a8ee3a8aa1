# SPDX-License-Identifier: Apache-2.0
"""What `ros2 launch` makes of a launch file with one node: PyPI has no `launch` for the tests."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path


def ros_arguments(launch_file: Path, given: dict[str, str]) -> list[str]:
    """Return the arguments that the node of an XML launch file is started with.

    Args:
        launch_file: with `arg`, and one `node` with `param` and `remap`.
        given: values of arguments; the others have their defaults.
    """
    root = ET.parse(launch_file).getroot()
    values = {each.attrib["name"]: each.attrib["default"] for each in root.iter("arg")}
    assert given.keys() <= values.keys()
    values |= given

    def of(text: str) -> str:
        return re.sub(r"\$\(var (\w+)\)", lambda match: values[match[1]], text)

    (node,) = root.iter("node")
    found = ["--ros-args", "-r", f"__node:={of(node.attrib['name'])}"]
    if of(node.attrib["namespace"]):
        found += ["-r", f"__ns:=/{of(node.attrib['namespace']).lstrip('/')}"]  # as launch makes it
    for each in node.iter("remap"):
        found += ["-r", f"{of(each.attrib['from'])}:={of(each.attrib['to'])}"]
    for each in node.iter("param"):
        value = of(each.attrib["value"])
        found += ["-p", f"{each.attrib['name']}:={value or repr('')}"]  # by the rules of YAML, as there
    return found
