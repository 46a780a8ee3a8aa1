// SPDX-License-Identifier: Apache-2.0
// Bindings of steady segments: their paths, slip rates and noise (thesis chapter 4).
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "checked_shapes.hpp"
#include "pose_matrix.hpp"
#include "slipwise/thesis/noise_fit.hpp"
#include "slipwise/thesis/slip_rate_fit.hpp"
#include "slipwise/thesis/steady_segment.hpp"
#include "thesis_bindings.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

std::vector<double> list_of(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

void bind_segments(nb::module_& m) {
  nb::class_<SteadySegment>(m, "SteadySegment",
                            "Poses [N, 3] seen from the first, at times [N] from 0 on, under one command.")
      .def(
          "__init__",
          [](SteadySegment* self, const BodyTwist& command, const Eigen::VectorXd& times,
             const Eigen::MatrixX3d& poses) {
            check_size(times, poses.rows(), "a path of poses with their times");
            std::vector<Pose2> list;
            for (Eigen::Index i = 0; i < poses.rows(); ++i) {
              list.push_back(Pose2::from_vector(poses.row(i).transpose()));
            }
            new (self) SteadySegment{command, list_of(times), std::move(list)};
          },
          "command"_a, "times"_a, "poses"_a)
      .def_ro("command", &SteadySegment::command)
      .def_ro("times", &SteadySegment::times)
      .def_prop_ro("poses", [](const SteadySegment& segment) { return pose_matrix(segment.poses); });
  nb::class_<SteadyNoise>(m, "SteadyNoise",
                          "Slip noise, start uncertainty P0 and variance of a measured pose, [3] each.")
      .def(nb::init<Eigen::Vector3d, Eigen::Vector3d, Eigen::Vector3d>(), "psd"_a, "start"_a, "pose"_a)
      .def_ro("psd", &SteadyNoise::psd)
      .def_ro("start", &SteadyNoise::start)
      .def_ro("pose", &SteadyNoise::pose);
  m.def(
      "steady_path",
      [](const BodyTwist& twist, const Eigen::VectorXd& times) {
        std::vector<Pose2> poses;
        for (const double t : times) {
          poses.push_back(steady_pose(twist, t));
        }
        return pose_matrix(poses);
      },
      "twist"_a, "times"_a, "Where a constant twist leads, [K, 3].");
  m.def(
      "steady_covariance",
      [](const BodyTwist& twist, const Eigen::VectorXd& times, const SteadyNoise& noise) {
        return steady_covariance(twist, list_of(times), noise);
      },
      "twist"_a, "times"_a, "noise"_a, "Covariance of the stacked charts at positive times [K], [3K, 3K].");
}

void bind_slip_rate_fit(nb::module_& m) {
  nb::class_<SlipRateSettings>(m, "SlipRateSettings")
      .def(nb::init<>())
      .def_rw("length", &SlipRateSettings::length)
      .def_rw("angular", &SlipRateSettings::angular)
      .def_rw("noise", &SlipRateSettings::noise)
      .def_rw("iterations", &SlipRateSettings::iterations)
      .def_rw("tolerance", &SlipRateSettings::tolerance);
  nb::class_<SlipRateFit>(m, "SlipRateFit", "Slip rates of a group of steady segments.")
      .def_ro("slip", &SlipRateFit::slip)
      .def_ro("covariance", &SlipRateFit::covariance)
      .def_ro("cost", &SlipRateFit::cost)
      .def_ro("rms", &SlipRateFit::rms)
      .def_ro("residuals", &SlipRateFit::residuals)
      .def_ro("iterations", &SlipRateFit::iterations)
      .def_ro("status", &SlipRateFit::status);
  m.def("steady_residuals", &steady_residuals, "segment"_a, "slip"_a, "Measured - predicted charts, [3, N - 1].");
  m.def(
      "fit_slip_rates",
      [](const std::vector<SteadySegment>& segments, const SlipRateSettings& settings) {
        return fit_slip_rates(segments, settings);
      },
      "segments"_a, "settings"_a);
}

void bind_noise_fit(nb::module_& m) {
  nb::enum_<ScatterCentre>(m, "ScatterCentre").value("Mean", ScatterCentre::Mean).value("Curve", ScatterCentre::Curve);
  nb::enum_<NoiseObjective>(m, "NoiseObjective")
      .value("Thesis", NoiseObjective::Thesis)
      .value("Fisher", NoiseObjective::Fisher);
  nb::class_<NoiseGroup>(m, "NoiseGroup", "Residuals [3, K] of segments at common times [K] along one steady twist.")
      .def(nb::init<BodyTwist, std::vector<double>, std::vector<Eigen::Matrix3Xd>>(), "twist"_a, "times"_a,
           "residuals"_a);
  nb::class_<NoiseFitSettings>(m, "NoiseFitSettings")
      .def(nb::init<>())
      .def_rw("objective", &NoiseFitSettings::objective)
      .def_rw("centre", &NoiseFitSettings::centre)
      .def_rw("pose", &NoiseFitSettings::pose)
      .def_rw("iterations", &NoiseFitSettings::iterations)
      .def_rw("tolerance", &NoiseFitSettings::tolerance);
  nb::class_<NoiseFit>(m, "NoiseFit", "Slip noise and start uncertainty, with the covariance [6, 6] of (psd, start).")
      .def_ro("noise", &NoiseFit::noise)
      .def_ro("covariance", &NoiseFit::covariance)
      .def_ro("scatter_definite", &NoiseFit::scatter_definite)
      .def_ro("iterations", &NoiseFit::iterations)
      .def_ro("status", &NoiseFit::status);
  m.def("scatter_matrix", &scatter_matrix, "group"_a, "centre"_a, "Scatter of the stacked charts, [3K, 3K].");
  m.def(
      "fit_noise",
      [](const std::vector<NoiseGroup>& groups, const NoiseFitSettings& settings) {
        return fit_noise(groups, settings);
      },
      "groups"_a, "settings"_a);
}

}  // namespace

void bind_steady(nb::module_& m) {
  bind_segments(m);
  bind_slip_rate_fit(m);
  bind_noise_fit(m);
}

}  // namespace slipwise::bindings
