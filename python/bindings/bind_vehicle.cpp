// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/vehicle and dynamics.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "bindings.hpp"
#include "sample_rows.hpp"
#include "slipwise/dynamics/dynamics_filter.hpp"
#include "slipwise/lie/body_twist.hpp"
#include "slipwise/vehicle/ackermann.hpp"
#include "slipwise/vehicle/differential_drive.hpp"
#include "slipwise/vehicle/towed_turns.hpp"
#include "slipwise/vehicle/wheel_layout.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

/// (v, omega) per row from two columns of what a drive measures.
template <typename TwistOfPair>
Eigen::MatrixX2d twist_rows(const Eigen::VectorXd& first, const Eigen::VectorXd& second, TwistOfPair twist_of) {
  if (first.size() != second.size()) {
    throw std::invalid_argument("the two columns must have equal lengths");
  }
  Eigen::MatrixX2d rows(first.size(), 2);
  for (Eigen::Index i = 0; i < first.size(); ++i) {
    const BodyTwist twist = twist_of(first[i], second[i]);
    rows.row(i) << twist.v, twist.omega;
  }
  return rows;
}

std::optional<Hinge> hinge_at(const std::optional<std::pair<double, double>>& place) {
  return place ? std::optional<Hinge>({.x = place->first, .y = place->second}) : std::nullopt;
}

/// One row of readings: all that was read at once.
WheelReadings readings_at(Eigen::Index row, const Rows& speed, const Rows& steering, const Rows& hinge,
                          const Rows& steering_rate) {
  WheelReadings readings{.speed = speed.row(row).transpose(), .steering = steering.row(row).transpose()};
  if (hinge.rows() > 0) {
    readings.hinge = hinge(row, 0);
    readings.hinge_rate = hinge(row, 1);
  }
  if (steering_rate.rows() > 0) {
    readings.steering_rate = steering_rate.row(row).transpose();
  }
  return readings;
}

void check_readings(const WheelLayout& layout, const Rows& speed, const Rows& steering, const Rows& hinge,
                    const Rows& steering_rate) {
  // A bent vehicle never passes as a straight one, nor steering that moves contacts for one at rest.
  const bool missing =
      speed.rows() > 0 && ((layout.hinged() && hinge.rows() == 0) || (layout.pivoted() && steering_rate.rows() == 0));
  const bool uneven =
      (hinge.rows() > 0 && (hinge.rows() != speed.rows() || hinge.cols() != 2)) ||
      (steering_rate.rows() > 0 && (steering_rate.rows() != speed.rows() || steering_rate.cols() != speed.cols()));
  if (steering.rows() != speed.rows() || missing || uneven) {
    throw std::invalid_argument(
        "speeds, steering angles and rates, and the hinge's (angle, rate) need equally many rows");
  }
}

/// Rows of (v, vy, omega, chi2, freedom), and of covariances (3 x 3, row by row).
std::pair<Rows, Rows> wheel_twists(const WheelLayout& layout, const Rows& speed, const Rows& steering,
                                   const Rows& hinge, const Rows& steering_rate) {
  check_readings(layout, speed, steering, hinge, steering_rate);
  Rows twists(speed.rows(), 5), covariances(speed.rows(), 9);
  for (Eigen::Index i = 0; i < speed.rows(); ++i) {
    const WheelTwist found = layout.twist(readings_at(i, speed, steering, hinge, steering_rate));
    twists.row(i) << found.twist.v, found.twist.vy, found.twist.omega, found.chi2, static_cast<double>(found.freedom);
    covariances.row(i) = Eigen::Map<const Eigen::RowVectorXd>(found.covariance.data(), 9);
  }
  return {twists, covariances};
}

/// Speeds and steering angles for rows of twists; each row starts from where the one before it left the steering.
std::pair<Rows, Rows> wheels_for_twists(const WheelLayout& layout, const Rows& twists) {
  if (twists.cols() != 3) {
    throw std::invalid_argument("twists need three columns: v, vy, omega");
  }
  const auto count = static_cast<Eigen::Index>(layout.wheels().size());
  Rows speed(twists.rows(), count), steering(twists.rows(), count);
  WheelReadings now{.speed = Eigen::VectorXd::Zero(count), .steering = Eigen::VectorXd::Zero(count)};
  for (Eigen::Index i = 0; i < twists.rows(); ++i) {
    const auto targets = layout.wheels_for({.v = twists(i, 0), .vy = twists(i, 1), .omega = twists(i, 2)}, now);
    speed.row(i) = targets.speed.transpose();
    steering.row(i) = targets.steering.transpose();
    now.steering = targets.steering;
  }
  return {speed, steering};
}

void bind_wheel_layout(nb::module_& m) {
  nb::class_<Wheel>(m, "Wheel", "One wheel on the ground, at (x, y) [m] in base_link.")
      .def(
          "__init__",
          [](Wheel* self, double x, double y, double radius, double angle, std::optional<double> roller, bool steered,
             bool behind_hinge, const std::optional<std::pair<double, double>>& pivot) {
            new (self) Wheel{.x = x,
                             .y = y,
                             .radius = radius,
                             .angle = angle,
                             .roller = roller,
                             .steered = steered,
                             .behind_hinge = behind_hinge,
                             .pivot = hinge_at(pivot)};
          },
          "x"_a, "y"_a, "radius"_a, "angle"_a, "roller"_a, "steered"_a, "behind_hinge"_a, "pivot"_a.none())
      .def_ro("x", &Wheel::x)
      .def_ro("y", &Wheel::y)
      .def_ro("radius", &Wheel::radius)
      .def_ro("angle", &Wheel::angle)
      .def_ro("roller", &Wheel::roller)
      .def_ro("steered", &Wheel::steered)
      .def_ro("behind_hinge", &Wheel::behind_hinge)
      .def_prop_ro("pivot", [](const Wheel& wheel) {
        using Place = std::pair<double, double>;
        return wheel.pivot ? std::optional<Place>({wheel.pivot->x, wheel.pivot->y}) : std::nullopt;
      });
  nb::class_<WheelLayout>(m, "WheelLayout", "Any set of wheels: body twist by least squares, and back.")
      .def(
          "__init__",
          [](WheelLayout* self, std::vector<Wheel> wheels, double rolling, double sideways,
             const std::optional<std::pair<double, double>>& hinge) {
            new (self) WheelLayout(std::move(wheels), {.rolling = rolling, .sideways = sideways}, hinge_at(hinge));
          },
          "wheels"_a, "rolling"_a, "sideways"_a, "hinge"_a.none())
      .def_prop_ro("wheels", &WheelLayout::wheels)
      .def_prop_ro("tells_sideways", &WheelLayout::tells_sideways)
      .def_prop_ro("pivoted", &WheelLayout::pivoted)
      .def("twists", &wheel_twists, "speed"_a, "steering"_a, "hinge"_a, "steering_rate"_a,
           "Rows of (v, vy, omega, chi2, freedom) and of covariances [9] from speeds and angles [N, wheels] in rad/s "
           "and rad, (angle, rate) of the hinge [N, 2], or [0, 2] where there is none, and rates of the steering "
           "[N, wheels], or [0, wheels] where no wheel has a pivot.")
      .def("wheels_for", &wheels_for_twists, "twists"_a,
           "Speeds and steering angles [N, wheels] that make twists [N, 3], the hinge straight.");
}

/// What a function of a user returned, of the shape that is needed.
Eigen::MatrixXd matrix_of(const nb::object& returned, const char* what, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd matrix;
  if (!nb::try_cast(returned, matrix) || matrix.rows() != rows || matrix.cols() != columns) {
    throw std::invalid_argument(std::string(what) + " must be an array of " + std::to_string(rows) + " x " +
                                std::to_string(columns) + " numbers");
  }
  return matrix;
}

/// Dynamics whose functions are Python's: rates of several states at once, and their derivatives or None.
class PythonDynamics final : public DynamicsModel {
 public:
  PythonDynamics(nb::object rates, nb::object jacobians) : rates_(std::move(rates)), jacobians_(std::move(jacobians)) {
    if (PyCallable_Check(rates_.ptr()) == 0 || (!jacobians_.is_none() && PyCallable_Check(jacobians_.ptr()) == 0)) {
      throw std::invalid_argument("rates and jacobians must be functions");
    }
  }

  Eigen::VectorXd derivative(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                             const Eigen::VectorXd& parameters) const override {
    return derivatives(state, input, parameters);
  }

  Eigen::MatrixXd derivatives(const Eigen::MatrixXd& states, const Eigen::VectorXd& input,
                              const Eigen::MatrixXd& parameters) const override {
    return matrix_of(rates_(states, input, parameters), "the derivative of the state", states.rows(), states.cols());
  }

  DynamicsJacobians jacobians(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                              const Eigen::VectorXd& parameters) const override {
    if (jacobians_.is_none()) {
      return DynamicsModel::jacobians(state, input, parameters);
    }
    const auto both = nb::cast<nb::tuple>(jacobians_(state, input, parameters));
    return {.by_state = matrix_of(both[0], "the Jacobian by the state", state.size(), state.size()),
            .by_parameter = matrix_of(both[1], "the Jacobian by the parameters", state.size(), parameters.size())};
  }

 private:
  nb::object rates_;
  nb::object jacobians_;  ///< or None
};

void bind_vehicle_settings(nb::module_& m) {
  nb::class_<DynamicsModel>(m, "DynamicsModel", "A user's own dynamics: x' = f(x, u, p).");
  nb::class_<PythonDynamics, DynamicsModel>(m, "PythonDynamics", "Dynamics whose functions are Python's.")
      .def(nb::init<nb::object, nb::object>(), "rates"_a, "jacobians"_a.none(),
           "Rates [states, N] of states [states, N], an input [inputs] and parameters [parameters, N]; Jacobians by "
           "state and by parameters of one state, or None for central differences.");
  nb::class_<DynamicsNoise>(m, "DynamicsNoise", "The measured part of a state, and its disturbance.")
      .def(
          "__init__",
          [](DynamicsNoise* self, std::vector<Eigen::Index> measured, std::vector<bool> angle,
             const Eigen::VectorXd& measurement_std, const Eigen::VectorXd& psd) {
            if (angle.size() != measured.size() || measurement_std.size() != std::ssize(measured)) {
              throw std::invalid_argument("each measured component needs a standard deviation, and whether it turns");
            }
            new (self) DynamicsNoise{std::move(measured), std::move(angle), measurement_std, psd};
          },
          "measured"_a, "angle"_a, "measurement_std"_a, "psd"_a);
  nb::class_<DynamicsUpdate>(m, "DynamicsUpdate", "One measurement's update.")
      .def_ro("innovation", &DynamicsUpdate::innovation, "[M] measured minus predicted.")
      .def_ro("nis", &DynamicsUpdate::nis, "Normalised innovation squared.")
      .def_ro("weight", &DynamicsUpdate::weight)
      .def_ro("status", &DynamicsUpdate::status);
  nb::class_<DynamicsPrediction>(m, "DynamicsPrediction", "Where the state will be.")
      .def_ro("t", &DynamicsPrediction::t, "[s]")
      .def_ro("state", &DynamicsPrediction::state, "[states]")
      .def_ro("covariance", &DynamicsPrediction::covariance, "[states, states]");
}

/// Inputs of a table, a row each.
HeldInputs held_inputs(const Eigen::VectorXd& t, const Eigen::MatrixXd& inputs) {
  if (t.size() != inputs.rows()) {
    throw std::invalid_argument("each input needs a stamp");
  }
  HeldInputs held;
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    held.push(t[i], inputs.row(i));
  }
  return held;
}

}  // namespace

void bind_vehicle(nb::module_& m) {
  bind_wheel_layout(m);
  nb::class_<BodyTwist>(m, "BodyTwist", "Body velocity (v [m/s], vy [m/s], omega [rad/s]).")
      .def(nb::init<double, double, double>(), "v"_a, "vy"_a, "omega"_a)
      .def_ro("v", &BodyTwist::v)
      .def_ro("vy", &BodyTwist::vy)
      .def_ro("omega", &BodyTwist::omega);
  nb::class_<DifferentialDrive>(m, "DifferentialDrive", "Differential or skid-steer drive (thesis 2.2).")
      .def(nb::init<double, double>(), "wheel_radius"_a, "wheel_separation"_a)
      .def_ro("wheel_radius", &DifferentialDrive::wheel_radius)
      .def_ro("wheel_separation", &DifferentialDrive::wheel_separation)
      .def(
          "twists",
          [](const DifferentialDrive& d, const Eigen::VectorXd& left, const Eigen::VectorXd& right) {
            return twist_rows(left, right, [&d](double l, double r) { return d.twist({l, r}); });
          },
          "left"_a, "right"_a, "Rows of (v [m/s], omega [rad/s]) from wheel speeds [N] in rad/s.");
  nb::class_<Ackermann>(m, "Ackermann", "A car with steered front wheels, seen at its rear axle.")
      .def(nb::init<double>(), "wheelbase"_a)
      .def_ro("wheelbase", &Ackermann::wheelbase)
      .def(
          "twists",
          [](const Ackermann& car, const Eigen::VectorXd& v, const Eigen::VectorXd& steer) {
            return twist_rows(v, steer, [&car](double speed, double angle) { return car.twist(speed, angle); });
          },
          "v"_a, "steer"_a, "Rows of (v [m/s], omega [rad/s]) from speeds [N] in m/s and steering angles [N] in rad.");
  m.def(
      "towed_turns",
      [](const Eigen::VectorXd& forward, const Eigen::VectorXd& rotation, const Rows& trailers, double most_folded,
         int parts) {
        check_columns(trailers, 3, "trailers");
        std::vector<Trailer> towed;
        for (const auto& row : trailers.rowwise()) {
          towed.push_back({.length = row[0], .turn = row[1], .behind = row[2]});
        }
        return towed_turns(forward, rotation, towed, most_folded, parts);
      },
      "forward"_a, "rotation"_a, "trailers"_a, "most_folded"_a, "parts"_a,
      "Turns [K, C] in rad of trailers, rows of (length [m], turn, behind) [C, 3], behind a robot of K steps.");
}

void bind_dynamics(nb::module_& m) {
  bind_vehicle_settings(m);
  nb::class_<DynamicsFilter>(m, "DynamicsFilter", "State and parameters of a user's dynamics, learned together.")
      .def(
          "__init__",
          [](DynamicsFilter* self, std::shared_ptr<const DynamicsModel> model, const DynamicsNoise& noise,
             double longest_step, double t, const Estimate& start) {
            new (self) DynamicsFilter(std::move(model), {.noise = noise, .longest_step = longest_step}, t, start);
          },
          "model"_a, "noise"_a, "longest_step"_a, "t"_a, "start"_a)
      .def("push_input", &DynamicsFilter::push_input, "t"_a, "input"_a, "Held from `t` [s] on.")
      .def("push_measurement", &DynamicsFilter::push_measurement, "t"_a, "measured"_a)
      .def(
          "predict",
          [](const DynamicsFilter& self, const std::vector<double>& times, const Eigen::VectorXd& t,
             const Eigen::MatrixXd& inputs) { return self.predict(times, held_inputs(t, inputs)); },
          "times"_a, "t"_a, "inputs"_a,
          "Where the state will be at times [s] under inputs [N, inputs] with stamps [N]; what is held now where there "
          "are none.")
      .def_prop_ro("time", &DynamicsFilter::time, "Of the last measurement [s].")
      .def_prop_ro("state", &DynamicsFilter::state)
      .def_prop_ro("parameters", &DynamicsFilter::parameters)
      .def_prop_ro("reported_parameters", &DynamicsFilter::reported_parameters);
}

}  // namespace slipwise::bindings
