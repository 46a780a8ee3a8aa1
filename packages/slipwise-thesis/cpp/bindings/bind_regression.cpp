// SPDX-License-Identifier: Apache-2.0
// Bindings of the regressions on slip surfaces (thesis chapter 5).
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "checked_shapes.hpp"
#include "slipwise/slip/basis.hpp"
#include "slipwise/thesis/bayesian_regression.hpp"
#include "slipwise/thesis/least_squares_surface.hpp"
#include "thesis_bindings.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

/// Means, standard deviations and the degrees of freedom, for rows of features.
std::pair<Eigen::VectorXd, Eigen::VectorXd> predict_rows(const BayesianRegression& regression,
                                                         const Eigen::MatrixXd& rows) {
  Eigen::VectorXd mean(rows.rows());
  Eigen::VectorXd std(rows.rows());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const RegressionPrediction at = regression.predict(rows.row(i).transpose());
    mean[i] = at.mean;
    std[i] = at.std();
  }
  return {mean, std};
}

Eigen::VectorXd mean_variances(const LeastSquaresFit& fit, const Eigen::MatrixXd& rows) {
  check_columns(rows, fit.scale.size(), "a prediction");
  Eigen::VectorXd variance(rows.rows());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    variance[i] = fit.mean_variance(rows.row(i).transpose());
  }
  return variance;
}

Eigen::MatrixXd feature_rows(const Basis& basis, const Eigen::VectorXd& v, const Eigen::VectorXd& omega) {
  if (v.size() != omega.size()) {
    throw std::invalid_argument("features need one yaw rate per speed");
  }
  Eigen::MatrixXd rows(v.size(), static_cast<Eigen::Index>(basis.size()));
  std::vector<double> values(basis.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    basis.features({.v = v[i], .omega = omega[i]}, values);
    rows.row(i) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), rows.cols());
  }
  return rows;
}

void bind_bayesian(nb::module_& m) {
  nb::class_<RegressionExample>(m, "RegressionExample", "Features [d], output, and its noise in units of the usual.")
      .def(nb::init<Eigen::VectorXd, double, double>(), "features"_a, "output"_a, "relative_std"_a);
  nb::class_<BayesianRegression>(m, "BayesianRegression", "Linear regression that knows how sure it is.")
      .def(
          "__init__",
          [](BayesianRegression* self, Eigen::VectorXd weight_std, double noise_std, double noise_examples) {
            new (self) BayesianRegression(
                {.weight_std = std::move(weight_std), .noise_std = noise_std, .noise_examples = noise_examples});
          },
          "weight_std"_a, "noise_std"_a, "noise_examples"_a)
      .def("add", &BayesianRegression::add, "example"_a)
      .def("remove", &BayesianRegression::remove, "example"_a)
      .def("merged", &BayesianRegression::merged, "other"_a)
      .def("predict_rows", &predict_rows, "features"_a, "Means [n] and standard deviations [n] for features [n, d].")
      .def_prop_ro("mean", &BayesianRegression::mean)
      .def_prop_ro("covariance", &BayesianRegression::covariance)
      .def_prop_ro("information", &BayesianRegression::information)
      .def_prop_ro("noise_variance", &BayesianRegression::noise_variance)
      .def_prop_ro("freedom", &BayesianRegression::freedom)
      .def_prop_ro("examples", &BayesianRegression::examples);
  nb::class_<SlidingRegression>(m, "SlidingRegression", "A regression on the latest examples alone.")
      .def(
          "__init__",
          [](SlidingRegression* self, const BayesianRegression& empty, std::size_t window) {
            new (self) SlidingRegression(empty.prior(), window);
          },
          "empty"_a, "window"_a)
      .def("add", &SlidingRegression::add, "example"_a)
      .def_prop_ro("regression", [](const SlidingRegression& sliding) { return sliding.regression(); });
}

void bind_least_squares(nb::module_& m) {
  nb::class_<LeastSquaresFit>(m, "LeastSquaresFit", "Least squares that says what it cannot determine.")
      .def_ro("coefficients", &LeastSquaresFit::coefficients)
      .def_ro("covariance", &LeastSquaresFit::covariance)
      .def_ro("not_identifiable", &LeastSquaresFit::not_identifiable)
      .def_ro("residual", &LeastSquaresFit::residual)
      .def_ro("leverage", &LeastSquaresFit::leverage)
      .def_prop_ro("rank", &LeastSquaresFit::rank)
      .def("mean_variances", &mean_variances, "features"_a, "Variance of the mean [n] for features [n, d].");
  m.def("fit_least_squares", &fit_least_squares, "design"_a, "output"_a, "relative_std"_a);
  m.def(
      "undetermined_directions",
      [](const LeastSquaresFit& fit, const std::vector<std::string>& terms) {
        return undetermined_directions(fit, terms);
      },
      "fit"_a, "terms"_a, "What the examples do not determine, in words.");
  m.def("thesis_std_coefficients", &thesis_std_coefficients, "design"_a, "fit"_a);
  nb::class_<LogVarianceFit>(m, "LogVarianceFit", "Standard deviation over speed and yaw rate; always positive.")
      .def("std", &LogVarianceFit::std, "v"_a, "omega"_a)
      .def_ro("coefficients", &LogVarianceFit::coefficients);
  m.def("fit_log_variance", &fit_log_variance, "drive"_a, "fit"_a);
}

}  // namespace

void bind_regression(nb::module_& m) {
  bind_bayesian(m);
  bind_least_squares(m);
  m.def("feature_rows", &feature_rows, "basis"_a, "v"_a, "omega"_a,
        "Features of every parameter on level terrain, [n, parameters].");
}

}  // namespace slipwise::bindings
