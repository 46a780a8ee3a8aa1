// SPDX-License-Identifier: Apache-2.0
// What was known of errors at a time holds no later ones; each structure's are its own.
#include <doctest/doctest.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "slipwise/archive/reader.hpp"
#include "slipwise/archive/writer.hpp"
#include "slipwise/online/held_out.hpp"

namespace slipwise {
namespace {

double inflation(const HorizonErrors::Known& known, Structure structure) {
  return known.students[static_cast<std::size_t>(structure)].inflation;
}

/// Each of whose numbers is another one.
HeldOutPrediction prediction(double number) {
  return {.run = 2,
          .horizon = 1,
          .start = number,
          .end = number + 1.0,
          .pose = {number, 2.0, 3.0},
          .covariance = (Eigen::Matrix3d() << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, number).finished(),
          .student = {.inflation = number + 2.0, .dof = number + 3.0},
          .nominal_nis = number + 4.0,
          .structure = Structure::Cascaded,
          .measured = {number, 4.0, 5.0},
          .baseline = {number, 6.0, 7.0},
          .in_sample = {number, 8.0, 9.0},
          .learned_until = number - 1.0};
}

HeldOutPredictions kept(std::size_t count) {
  HeldOutPredictions predictions;
  for (std::size_t i = 0; i < count; ++i) {
    predictions.keep(std::make_shared<const HeldOutPrediction>(prediction(static_cast<double>(i))));
  }
  return predictions;
}

}  // namespace

TEST_CASE("the last predictions are kept, and copies share them") {
  const HeldOutPredictions predictions = kept(HeldOutPredictions::kMost + 3);
  const HeldOutPredictions copy = predictions;  // NOLINT(performance-unnecessary-copy-initialization)
  CHECK(predictions.size() == HeldOutPredictions::kMost);
  CHECK(predictions[0].start == 3.0);
  CHECK(&copy[0] == &predictions[0]);
  CHECK(copy.back().start == static_cast<double>(HeldOutPredictions::kMost + 2));
}

TEST_CASE("predictions are saved as a list of them, and read back") {
  archive::Writer writer;
  writer(kept(5));
  archive::Writer list;
  list(std::vector<HeldOutPrediction>{prediction(0.0), prediction(1.0), prediction(2.0), prediction(3.0),
                                      prediction(4.0)});
  CHECK(writer.bytes() == list.bytes());
  archive::Reader reader(writer.bytes());
  HeldOutPredictions read = kept(2);
  reader(read);
  reader.finish();
  REQUIRE(read.size() == 5);
  CHECK(read[4].covariance == prediction(4.0).covariance);
  archive::Reader cut(std::string_view(writer.bytes()).substr(0, writer.bytes().size() - 9));
  CHECK_THROWS_AS(cut(read), std::invalid_argument);
}

TEST_CASE("columns hold the numbers of each prediction in its row") {
  const HeldOutColumns columns(kept(3));
  const HeldOutPrediction last = prediction(2.0);
  CHECK(columns.run == HeldOutColumns::Numbers::Constant(3, 2));
  CHECK(columns.structure == HeldOutColumns::Numbers::Constant(3, static_cast<int>(Structure::Cascaded)));
  CHECK(columns.start == Eigen::Vector3d(0.0, 1.0, 2.0));
  CHECK(columns.end[2] == last.end);
  CHECK(columns.inflation[2] == last.student.inflation);
  CHECK(columns.dof[2] == last.student.dof);
  CHECK(columns.nominal_nis[2] == last.nominal_nis);
  CHECK(columns.learned_until[2] == last.learned_until);
  CHECK(columns.pose.row(2) == last.pose.transpose());
  CHECK(columns.measured.row(2) == last.measured.transpose());
  CHECK(columns.baseline.row(2) == last.baseline.transpose());
  CHECK(columns.in_sample.row(2) == last.in_sample.transpose());
  CHECK(columns.covariance(2, 1) == 2.0);
  CHECK(columns.covariance(2, 3) == 4.0);
  CHECK(columns.covariance(2, 8) == 2.0);
  CHECK(HeldOutColumns(HeldOutPredictions()).pose.rows() == 0);
  CHECK_THROWS_AS(HeldOutColumns(std::vector<const HeldOutPrediction*>{nullptr}), std::invalid_argument);
}

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
