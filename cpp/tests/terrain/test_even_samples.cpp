// SPDX-License-Identifier: Apache-2.0
// Streams are interpolated to even times, unless samples are missing.
#include "slipwise/terrain/even_samples.hpp"

#include <doctest/doctest.h>

namespace slipwise {
namespace {

TEST_CASE("a line stays a line at other times") {
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(41, 0.0, 4.0);
  const SampleRows values = 2.0 * times;
  const auto found = even_samples(times, values, 1.03, {2.0, 8.0});
  REQUIRE(found);
  REQUIRE(found->rows() == 16);
  for (Eigen::Index i = 0; i < found->rows(); ++i) {
    CHECK((*found)(i, 0) == doctest::Approx(2.0 * (1.03 + static_cast<double>(i) / 8.0)));
  }
}

TEST_CASE("five missing samples break a window, four do not") {
  const auto with_gap = [](int missing) {
    Eigen::VectorXd times(40);
    for (int i = 0; i < 40; ++i) {
      times[i] = 0.1 * (i < 20 ? i : i + missing);
    }
    const SampleRows values = SampleRows::Ones(40, 2);
    return even_samples(times, values, 1.0, {2.0, 10.0}).has_value();
  };
  CHECK(with_gap(3));
  CHECK_FALSE(with_gap(5));
}

TEST_CASE("a window beside the stream, or without a rate, is none") {
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(41, 0.0, 4.0);
  const SampleRows values = SampleRows::Ones(41, 1);
  CHECK_FALSE(even_samples(times, values, 3.0, {2.0, 10.0}));
  CHECK_FALSE(even_samples(times, values, 9.0, {2.0, 10.0}));
  CHECK_FALSE(even_samples(times, values, 0.0, {2.0, 0.0}));
  CHECK_THROWS_AS((void)even_samples(times, SampleRows::Ones(3, 1), 0.0, {2.0, 10.0}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
