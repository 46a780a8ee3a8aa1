# SPDX-License-Identifier: Apache-2.0
"""The C++ reference of the site shows what is public in the headers, and nothing of how it is done."""

from __future__ import annotations

import re

import pytest
from docs.cpp_reference import FOLDERS, HEADERS, declarations, page, shown

HEADER = """
/// What a robot is.
template <typename T>
class Robot {
 public:
  explicit Robot(double size) : size_{size}, name_("{") {}
  /// Drives on.
  /// \\throws std::invalid_argument for no speed.
  T drive(double v) const { return T{v * size_}; }
  struct Part {
    double mass = 0.0;  ///< [kg]
                        ///< of it alone
  };

 private:
  double size_;
};

namespace inner {
inline int hidden() { return 1; }
}

enum class Kind { One, Two };
inline constexpr Kind kKinds[] = {Kind::One, Kind::Two};  // all
/// Free.
inline double twice(double x) {
  return 2.0 * x;  // }
}
"""


def test_bodies_private_members_and_inner_namespaces_are_left_out() -> None:
    found = dict(shown(HEADER))
    text = "\n".join(part for _, part in shown(HEADER))
    assert {"Robot", "Kind"} <= set(found)
    for hidden in ("size_", "name_", "return", "hidden", "private"):
        assert hidden not in text
    for said in ("/// Drives on.", "T drive(double v) const;", "explicit Robot(double size);", "/// Free."):
        assert said in text
    assert "double mass = 0.0;  ///< [kg]" in text
    assert "inline constexpr Kind kKinds[] = {Kind::One, Kind::Two};  // all" in text
    assert "inline double twice(double x);" in text


def test_a_comment_belongs_to_the_declaration_below_it() -> None:
    found = list(declarations("// far\n\n/// near\nint a;\nint b;\n"))
    assert [(comment, head) for comment, head, *_ in found] == [("/// near", "int a;"), ("", "int b;")]


def test_a_page_names_every_header_and_every_type_with_a_comment(subtests: pytest.Subtests) -> None:
    for folder in FOLDERS:
        with subtests.test(folder=folder):
            text = page(folder)
            for header in (HEADERS / folder).glob("*.hpp"):
                assert f"## {header.name}" in text
                source = header.read_text(encoding="utf-8")
                for name in re.findall(r"^(?:class|struct) (\w+)(?: final)? \{", source, re.MULTILINE):
                    assert f"### {name}\n" in text, name
            code = "\n".join(re.findall(r"^```cpp\n(.*?)^```", text, re.DOTALL | re.MULTILINE))
            bare = re.sub(r"//[^\n]*", "", code)
            assert bare.count("{") == bare.count("}")
            assert not re.search(r"\breturn\b|\w_;", bare)


def test_the_learner_is_shown_with_what_it_is_given() -> None:
    text = page("online")
    assert "void push(const Measurement& measurement);" in text
    assert "/// Nothing more comes of this run: what waits for later measurements is learned." in text
