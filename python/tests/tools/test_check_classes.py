# SPDX-License-Identifier: Apache-2.0
"""The checker of classes counts what C++ and Python classes declare, and large ones may only shrink."""

import pytest
from tools.check_classes import LARGER, MOST_METHODS, cpp_classes, faults_of, python_classes

HEADER = """namespace slipwise {

class Small {
 public:
  explicit Small(int size);
  /// What it is.
  int size() const { return size_; }
  const std::vector<std::pair<int, double>>& all(
      int first) const;
  int all() const;
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.size_);
  }
  friend bool operator==(const Small&, const Small&) = default;

 private:
  struct Inner {
    int value;
  };
  int hidden(double x);

  static constexpr int kMost = 3;
  int size_ = 0;  ///< of it (all)
  std::vector<int> all_;
};

}  // namespace slipwise
"""
MODULE = """class Learner:
    rate: float
    _kept: int = 0

    def learn(self) -> None: ...

    def _slice(self) -> None: ...
"""


def test_public_methods_are_counted_by_name_and_members_by_declaration() -> None:
    assert list(cpp_classes(HEADER)) == [("Small", 3, 2)]
    assert list(python_classes(MODULE)) == [("Learner", 1, 2)]


def test_a_class_of_data_may_have_many_members_and_one_of_methods_may_not() -> None:
    assert faults_of("a/b.hpp", "Job", 1, 30) == []
    assert faults_of("a/b.hpp", "Learner", MOST_METHODS, 12) == []
    assert "split it" in faults_of("a/b.hpp", "Learner", MOST_METHODS + 1, 3)[0]
    assert "split it" in faults_of("a/b.hpp", "Learner", 3, 13)[0]


@pytest.mark.parametrize(("more", "said"), [(1, "larger"), (-1, "smaller")])
def test_a_class_that_was_large_neither_grows_nor_keeps_a_number_that_it_no_longer_needs(
    more: int, said: str
) -> None:
    key, (methods, members) = next(iter(LARGER.items()))
    file, name = key.split()
    assert faults_of(file, name, methods, members) == []
    assert said in faults_of(file, name, methods + more, members)[0]
