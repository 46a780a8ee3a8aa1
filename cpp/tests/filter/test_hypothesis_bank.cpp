// SPDX-License-Identifier: Apache-2.0
#include "slipwise/filter/hypothesis_bank.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace slipwise;

namespace {

HypothesisBank<char> bank_of(const std::vector<std::pair<char, double>>& priors) {
  HypothesisBank<char> bank;
  for (const auto& [key, prior] : priors) {
    bank.add(key, prior, std::log(prior));
  }
  bank.normalise();
  return bank;
}

}  // namespace

TEST_CASE("Bayes from the evidence is the product of likelihoods and priors, and its log evidence their mean") {
  HypothesisBank<char> bank = bank_of({{'a', 0.2}, {'b', 0.8}});
  bank.weigh(Eigen::Vector2d(std::log(3.0), std::log(0.5)));
  bank.weigh(Eigen::Vector2d(std::log(2.0), 0.0));
  CHECK(bank.weights()[0] == doctest::Approx(1.2 / 1.6));
  CHECK(bank.log_evidence() == doctest::Approx(std::log(1.6)));
  CHECK(bank[bank.heaviest()] == 'a');
}

TEST_CASE("learning is tempered Bayes under priors that need not add up to 1, and counts what spoke") {
  HypothesisBank<char> bank = bank_of({{'a', 1.0}, {'b', 3.0}});
  bank.pass();
  const Eigen::Vector2d before = bank.weights();
  bank.learn(Eigen::Vector2d(1.0, -1.0), {});
  CHECK(bank.weights().isApprox(updated_weights(before, Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(0.25, 0.75), {}, 1),
                                1e-15));
  CHECK(bank.observed() == 2);
}

TEST_CASE("a hypothesis that joins late has the part of the weight that it would have had from the start") {
  HypothesisBank<char> late = bank_of({{'a', 1.0}, {'b', 2.0}});
  late.join('c', 1.5, 0.0);
  CHECK(late.weights().isApprox(bank_of({{'a', 1.0}, {'b', 2.0}, {'c', 1.5}}).weights(), 1e-15));
  CHECK(late.place_of('c') == 2);
  CHECK(late.place_of('d') == late.size());
}

TEST_CASE("those that are chosen keep what was known of them, in the order of the choice") {
  const HypothesisBank<char> bank = bank_of({{'a', 0.2}, {'b', 0.3}, {'c', 0.5}});
  HypothesisBank<char> some = bank.chosen(std::array<std::size_t, 3>{2, 0, 2});
  CHECK(some.keys() == std::vector{'c', 'a', 'c'});
  CHECK(some.weights().isApprox(Eigen::Vector3d(0.5, 0.2, 0.5), 1e-15));
  CHECK(some.evidence()[1] == doctest::Approx(std::log(0.2)));
  some.normalise();
  CHECK(some.weights().sum() == doctest::Approx(1.0));
  some.favour(1, 0.9);
  CHECK(some.weights().isApprox(Eigen::Vector3d(0.05, 0.9, 0.05), 1e-12));
}

TEST_CASE("weights that are none are found") {
  HypothesisBank<char> bank = bank_of({{'a', 0.2}, {'b', 0.8}});
  CHECK_NOTHROW(bank.check_sizes(2));
  CHECK_THROWS_AS(bank.check_sizes(3), std::invalid_argument);
  bank.begin_with(Eigen::Vector2d(-0.1, 1.1), 0);
  CHECK_THROWS_AS(bank.check_sizes(2), std::invalid_argument);
}
