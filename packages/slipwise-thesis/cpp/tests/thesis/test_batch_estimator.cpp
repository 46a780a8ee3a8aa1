// SPDX-License-Identifier: Apache-2.0
// The batch fit behind the interface of the estimators: what it returns, when, and that it keeps what it was given.
#include <doctest/doctest.h>

#include <optional>
#include <vector>

#include "sample_bases.hpp"
#include "simulated_drive.hpp"
#include "slipwise/filter/batch.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/thesis/estimator.hpp"

namespace slipwise {
namespace {

const Eigen::Vector3d kScale(2.0, 0.5, 3.0);

EstimatorSettings settings_with(double huber) {
  EstimatorSettings settings;
  settings.noise = tests::kNoise;
  settings.iekf.huber = huber;
  return settings;
}

tests::SimulatedDrive drive_of(const MotionModel& model) {
  return tests::simulate_drive(model, tests::sample_slip(model.basis(), 91, 0.1),
                               {.seed = 92, .windows = 60, .noise = tests::kNoise});
}

TEST_CASE("its estimate is the batch fit of all segments under the noise it was commanded") {
  const MotionModel model(named_basis("drive-5"), {});
  const auto drive = drive_of(model);
  Estimator estimator = make_estimator("batch", model, tests::wide_prior(model), settings_with(1.5));
  std::vector<BatchDatum> data;
  for (const Segment& segment : drive.segments) {
    estimator.learn(drive.inputs, segment);
    const SegmentPath path = integrate_segment(model, Eigen::VectorXd::Zero(model.size()), drive.inputs, segment);
    data.push_back({drive.inputs, segment, segment_noise(path, rows_of(segment.measured), tests::kNoise, kScale)});
  }
  estimator.scale_noise(kScale);
  const Estimate fit = batch_fit(model, tests::wide_prior(model), data, {.huber = 1.5}).estimate;
  CHECK(estimator.estimate().mean == fit.mean);
  CHECK(estimator.estimate().covariance == fit.covariance);
}

TEST_CASE("updates and running posterior are those of the iekf, and before any segment all is the prior") {
  const MotionModel model(named_basis("drive-5"), {});
  const auto drive = drive_of(model);
  Estimator batch = make_estimator("batch", model, tests::wide_prior(model), settings_with(2.5));
  Estimator filter = make_estimator("iekf", model, tests::wide_prior(model), settings_with(2.5));
  CHECK(batch.estimate().mean == tests::wide_prior(model).mean);
  CHECK(batch.estimate().covariance == tests::wide_prior(model).covariance);
  for (const Segment& segment : drive.segments) {
    CHECK(batch.learn(drive.inputs, segment).nis == filter.learn(drive.inputs, segment).nis);
    CHECK(batch.running().mean == filter.estimate().mean);
  }
  CHECK(filter.running().mean == filter.estimate().mean);
  CHECK(batch.running().mean != batch.estimate().mean);
}

TEST_CASE("it needs the inputs no longer than learning takes") {
  const MotionModel model(named_basis("edd-2"), {});
  const auto drive = drive_of(model);
  Estimator known = make_estimator("batch", model, tests::wide_prior(model), settings_with(2.5));
  Estimator alone = make_estimator("batch", model, tests::wide_prior(model), settings_with(2.5));
  std::optional<InputHistory> passing(drive.inputs);
  for (const Segment& segment : drive.segments) {
    known.learn(drive.inputs, segment);
    alone.learn(*passing, segment);
  }
  passing.reset();
  CHECK(alone.estimate().mean == known.estimate().mean);
}

}  // namespace
}  // namespace slipwise
