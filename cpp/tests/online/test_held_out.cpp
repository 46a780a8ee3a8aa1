// SPDX-License-Identifier: Apache-2.0
// What was known of errors at a time holds no later ones; each structure's are its own.
#include <doctest/doctest.h>

#include "slipwise/online/held_out.hpp"

namespace slipwise {
namespace {

double inflation(const HorizonErrors::Known& known, Structure structure) {
  return known.students[static_cast<std::size_t>(structure)].inflation;
}

}  // namespace

TEST_CASE("errors count from when they were known on, for their structure alone") {
  HorizonErrors errors;
  const double prior = inflation(errors.before(1e9), Structure::Joint);
  for (int i = 0; i < 10; ++i) {
    errors.learn(10.0 + i, Structure::Joint, 60.0, 60.0);  // twenty times what is expected of three dimensions
  }
  CHECK(inflation(errors.before(9.9), Structure::Joint) == prior);
  CHECK(errors.before(12.5).until == 12.0);
  CHECK(inflation(errors.before(12.5), Structure::Joint) > prior);
  CHECK(inflation(errors.before(19.0), Structure::Joint) > inflation(errors.before(12.5), Structure::Joint));
  CHECK(inflation(errors.before(19.0), Structure::Direct) == prior);
}

TEST_CASE("errors without recent segments are calibrated apart") {
  HorizonErrors errors;
  for (int i = 0; i < 30; ++i) {
    errors.learn(10.0 + i, Structure::Joint, 3.0, 60.0);
  }
  CHECK(errors.nominal(Structure::Joint).inflation > 3.0 * inflation(errors.before(1e9), Structure::Joint));
}

TEST_CASE("when the clock is set back, all errors so far are known") {
  HorizonErrors errors;
  errors.learn(1000.0, Structure::Joint, 60.0, 60.0);
  const double learned = inflation(errors.before(1000.0), Structure::Joint);
  errors.restart_clock();
  CHECK(inflation(errors.before(5.0), Structure::Joint) == learned);
}

}  // namespace slipwise
