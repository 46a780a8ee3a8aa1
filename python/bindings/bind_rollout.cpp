// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/rollout.
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "bindings.hpp"
#include "checked_shapes.hpp"
#include "slipwise/rollout/car_batch.hpp"
#include "slipwise/rollout/gpu/gpu.hpp"
#include "slipwise/rollout/rollout_batch.hpp"
#include "slipwise/rollout/rollout_covariance.hpp"
#include "slipwise/rollout/sampled_futures.hpp"
#include "slipwise/slip/mixed_ahead.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

template <typename Scalar>
using Commands = nb::ndarray<const Scalar, nb::ndim<3>, nb::device::cpu>;
template <typename Scalar, std::size_t kDimensions>
using Output = std::optional<nb::ndarray<Scalar, nb::ndim<kDimensions>, nb::c_contig, nb::device::cpu>>;
using Starts = nb::ndarray<const double, nb::shape<-1, 6>, nb::c_contig, nb::device::cpu>;
using Past = nb::ndarray<const double, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;
using Cells = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// Where rollouts start: (x, y, theta, v, vy, omega) per start, and the commands (v, vy, omega) sent before.
struct StartList {
  std::vector<RolloutStart> starts;
  std::vector<DriveCommand> past;
};

StartList start_list(const Starts& starts, const Past& past) {
  StartList list;
  for (std::size_t i = 0; i < starts.shape(0); ++i) {
    const double* row = starts.data() + 6 * i;
    list.starts.push_back({{row[0], row[1], row[2]}, {.v = row[3], .omega = row[5], .vy = row[4]}});
  }
  for (std::size_t i = 0; i < past.shape(0) * past.shape(1); ++i) {
    const double* row = past.data() + 3 * i;
    list.past.push_back({.v = row[0], .omega = row[2], .vy = row[1]});
  }
  return list;
}

/// Commands are (v, omega), or (v, vy, omega) of a robot that drives sideways.
template <typename Scalar>
RolloutBatch<Scalar> batch_of(const Commands<Scalar>& commands, const StartList& list) {
  if (commands.shape(2) != 2 && commands.shape(2) != 3) {
    throw std::invalid_argument("commands are (v, omega) or (v, vy, omega)");
  }
  const auto last = static_cast<std::ptrdiff_t>(commands.shape(2)) - 1;
  return {.rollouts = commands.shape(0),
          .periods = commands.shape(1),
          .commands = {commands.data(), commands.data() + last * commands.stride(2), commands.stride(0),
                       commands.stride(1), last == 2 ? commands.data() + commands.stride(2) : nullptr},
          .starts = list.starts,
          .past = list.past};
}

/// Row i of an output, which must hold rows of `size` numbers; null where it is not wanted.
template <typename Scalar, std::size_t kDimensions>
Scalar* row_of(const Output<Scalar, kDimensions>& output, std::size_t i, std::size_t size) {
  if (!output) {
    return nullptr;
  }
  if (output->size() != 3 * size) {
    throw std::invalid_argument("an output has " + std::to_string(output->size()) + " numbers where " +
                                std::to_string(3 * size) + " are needed");
  }
  return output->data() + i * size;
}

InstructionLevel level_named(const std::string& name) {
  for (const InstructionLevel level : kInstructionLevels) {
    if (name_of(level) == name) {
      return level;
    }
  }
  throw std::invalid_argument("unknown instruction level '" + name + "'; known are portable, avx2, avx512");
}

/// Without limits the commands pass as they are. `ground` is (gx, gy, rise_x, rise_y).
RolloutSetting setting(double period, const std::array<double, 4>& ground, const CommandLimits* limits,
                       const SlipAhead& ahead, bool sideways) {
  return {.period = period,
          .gx = ground[0],
          .gy = ground[1],
          .limits = limits == nullptr ? CommandLimits{} : *limits,
          .rise_x = ground[2],
          .rise_y = ground[3],
          .ahead = ahead,
          .sideways = sideways};
}

/// What cars do under commands of throttle and steering: fills `out` [2, K, N]; returns the twists of the past.
template <typename Scalar>
Eigen::MatrixX2d car_twists(const CarCurves& car, const Commands<Scalar>& commands, const StartList& starts,
                            double period, nb::ndarray<Scalar, nb::ndim<3>, nb::c_contig, nb::device::cpu> out,
                            unsigned threads) {
  const CarBatch<Scalar> found =
      car_batch<Scalar>(car, batch_of<Scalar>(commands, starts), period, {.threads = threads});
  if (out.size() != 2 * found.v.size()) {
    throw std::invalid_argument("the twists of cars need room for two numbers a command");
  }
  std::ranges::copy(found.omega, std::ranges::copy(found.v, out.data()).out);
  Eigen::MatrixX2d past(static_cast<Eigen::Index>(found.past.size()), 2);
  for (std::size_t i = 0; i < found.past.size(); ++i) {
    past.row(static_cast<Eigen::Index>(i)) << found.past[i].v, found.past[i].omega;
  }
  return past;
}

template <typename Scalar>
void bind_batch(nb::module_& m) {
  m.def("car_twists", &car_twists<Scalar>, "car"_a, "commands"_a, "starts"_a, "period"_a, "out"_a, "threads"_a,
        "Mean twists of cars over each period under commands [N, K, 2] of throttle and steering: fills out [2, K, N], "
        "and returns those of the past [S * P, 2].");
  m.def(
      "rollout_batch",
      [](const RolloutProgram& program, const Commands<Scalar>& commands, const StartList& starts,
         const Output<Scalar, 3>& path, const Output<Scalar, 2>& end, const Costmap* map,
         const Output<Scalar, 2>& costs, unsigned threads, const std::string& level, Gpu* gpu) {
        const RolloutBatch<Scalar> batch = batch_of<Scalar>(commands, starts);
        const std::size_t n = batch.rollouts;
        const std::size_t poses = n * batch.periods;
        const RolloutOutputs<Scalar> outputs{
            .x = row_of<Scalar, 3>(path, 0, poses),
            .y = row_of<Scalar, 3>(path, 1, poses),
            .theta = row_of<Scalar, 3>(path, 2, poses),
            .end_x = row_of<Scalar, 2>(end, 0, n),
            .end_y = row_of<Scalar, 2>(end, 1, n),
            .end_theta = row_of<Scalar, 2>(end, 2, n),
            .map = map,
            .cost_sum = row_of<Scalar, 2>(costs, 0, n),
            .cost_highest = row_of<Scalar, 2>(costs, 1, n),
            .cost_lowest = row_of<Scalar, 2>(costs, 2, n),
        };
        const nb::gil_scoped_release release;
        rollout_batch(program, batch, outputs, {threads, level_named(level), gpu});
      },
      "program"_a, "commands"_a, "starts"_a, "path"_a.none(), "end"_a.none(), "map"_a.none(), "costs"_a.none(),
      "threads"_a, "level"_a, "gpu"_a.none(),
      "Drives commands [N, K, 2 or 3]; fills path [3, K, N], end [3, N] and costs [3, N] (sum, highest, lowest). On "
      "the "
      "processor, with these threads and instructions, where gpu is None.");
}

template <typename Scalar>
void bind_uncertain_batch(nb::module_& m) {
  m.def(
      "rollout_covariance",
      [](const UncertainModel& model, const Commands<Scalar>& commands, const StartList& starts,
         nb::ndarray<Scalar, nb::ndim<3>, nb::c_contig, nb::device::cpu> out, const std::vector<double>& growth,
         unsigned threads) {
        const nb::gil_scoped_release release;
        rollout_covariance(model, batch_of<Scalar>(commands, starts), {out.data(), out.size()}, growth,
                           {.threads = threads});
      },
      "model"_a, "commands"_a, "starts"_a, "out"_a, "growth"_a, "threads"_a,
      "Fills out [6, K, N] with (xx, xy, yy, xt, yt, tt) of every pose, times the growth [K] of its period.");
  m.def(
      "sample_futures",
      [](const UncertainModel& model, const Commands<Scalar>& commands, const StartList& starts, std::uint64_t seed,
         nb::ndarray<Scalar, nb::ndim<4>, nb::c_contig, nb::device::cpu> out, unsigned threads) {
        const std::size_t size = out.size() / 3;
        Scalar* data = out.data();
        const nb::gil_scoped_release release;
        sample_futures(model, batch_of<Scalar>(commands, starts), seed,
                       FutureOutputs<Scalar>{{data, size}, {data + size, size}, {data + 2 * size, size}},
                       {.threads = threads});
      },
      "model"_a, "commands"_a, "starts"_a, "seed"_a, "out"_a, "threads"_a,
      "Fills out [3, S, K, N] with poses drawn from the learned distribution.");
}

void bind_uncertain(nb::module_& m) {
  nb::class_<UncertainModel>(m, "UncertainModel", "A model with its parameters and how uncertain it is.")
      .def(
          "__init__",
          [](UncertainModel* self, const MotionModel& model, const Eigen::VectorXd& parameters,
             const Eigen::MatrixXd& covariance, const MotionNoise& noise, const Eigen::Vector3d& scale,
             double inflation, const DisturbanceModel& disturbance, const Eigen::VectorXd& prior_std, double period,
             const std::array<double, 4>& ground, const CommandLimits* limits, const MixedAhead* ahead, bool sideways) {
            model.check(parameters);
            check_square(covariance, model.size(), "the covariance of a model");
            check_size(prior_std, model.size(), "the prior of a model");
            new (self) UncertainModel{
                model,
                parameters,
                {covariance, noise, scale, inflation, disturbance, prior_std,
                 ahead == nullptr ? std::vector<Eigen::MatrixXd>{} : ahead->directions},
                setting(period, ground, limits, ahead == nullptr ? SlipAhead{} : ahead->ahead, sideways)};
          },
          "model"_a, "parameters"_a, "covariance"_a, "noise"_a, "scale"_a, "inflation"_a, "disturbance"_a,
          "prior_std"_a, "period"_a, "ground"_a, "limits"_a.none(), "ahead"_a.none(), "sideways"_a,
          nb::keep_alive<1, 2>());
}

}  // namespace

void bind_rollout(nb::module_& m) {
  nb::class_<RolloutProgram>(m, "RolloutProgram", "A motion model compiled for rollouts of one control period.")
      .def(
          "__init__",
          [](RolloutProgram* self, const MotionModel& model, const Eigen::VectorXd& parameters, double period,
             const std::array<double, 4>& ground, const CommandLimits* limits, const MixedAhead* ahead, bool sideways) {
            new (self) RolloutProgram(
                model, parameters,
                setting(period, ground, limits, ahead == nullptr ? SlipAhead{} : ahead->ahead, sideways));
          },
          "model"_a, "parameters"_a, "period"_a, "ground"_a, "limits"_a.none(), "ahead"_a.none(), "sideways"_a,
          "`ground` is gravity along the robot's x and y axes [m/s^2], and the rise of a plane per metre along the "
          "axes "
          "of the starts' frame: one of the two pairs is zero. `sideways`: commands are (v, vy, omega).")
      .def_prop_ro("period", [](const RolloutProgram& program) { return program.setting().period; });
  nb::class_<StartList>(m, "StartList", "Where rollouts start.")
      .def(
          "__init__",
          [](StartList* self, const Starts& starts, const Past& past) {
            new (self) StartList(start_list(starts, past));
          },
          "starts"_a, "past"_a);
  nb::class_<Costmap>(m, "CostmapView", "A costmap in the kernels' terms; the owner of its cells must outlive it.")
      .def(
          "__init__",
          [](Costmap* self, const Cells& cells, double resolution, double x, double y, float outside) {
            new (self) Costmap{{cells.data(), cells.size()}, cells.shape(0), cells.shape(1), resolution, x, y, outside};
          },
          "cells"_a, "resolution"_a, "origin_x"_a, "origin_y"_a, "outside"_a, nb::keep_alive<1, 2>());
  m.def(
      "instruction_levels",
      [] {
        std::vector<std::string> names;
        for (const InstructionLevel level : kInstructionLevels) {
          if (has_instruction_level(level)) {
            names.emplace_back(name_of(level));
          }
        }
        return names;
      },
      "Names of the instruction levels that this processor has, the slowest first.");
  m.def("why_no_gpu", &why_no_gpu, "Why rollouts cannot run on a GPU here; empty where they can.");
  nb::class_<Gpu>(m, "Gpu", "A GPU that drives rollouts, with the memory that batches took so far.").def(nb::init<>());
  bind_batch<float>(m);
  bind_batch<double>(m);
  bind_uncertain(m);
  bind_uncertain_batch<float>(m);
  bind_uncertain_batch<double>(m);
}

}  // namespace slipwise::bindings
