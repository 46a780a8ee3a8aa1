// SPDX-License-Identifier: Apache-2.0
// Sample, drive, weigh.
#include "slipwise/planning/mppi.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "slipwise/rollout/car_batch.hpp"

namespace slipwise {
namespace {

void need(bool fine, const char* fault) {
  if (!fine) {
    throw std::invalid_argument(fault);
  }
}

bool positive(double value) { return value > 0.0 && std::isfinite(value); }
bool not_negative(double value) { return value >= 0.0 && std::isfinite(value); }

void check_models(const std::vector<RolloutProgram>& models, const MppiSettings& settings) {
  need(!models.empty(), "give at least one model to drive through");
  for (const RolloutProgram& model : models) {
    need(model.setting().period == settings.period, "the models' period must be that of the controller");
    need(model.sideways() == models.front().sideways(), "models that drive sideways do not mix with others");
  }
}

float correlation(const MppiSettings& settings) {
  return settings.colour > 0.0 ? static_cast<float>(std::exp(-settings.period / settings.colour)) : 0.0F;
}

std::vector<MppiAxis> axes_of(const MppiSettings& settings, bool sideways) {
  const MppiLimits& limits = settings.limits;
  std::vector<MppiAxis> axes;
  const auto add = [&](double DriveCommand::* part, double spread, double lowest, double highest, double rate) {
    const std::uint64_t seed = settings.seed + axes.size() * 0x5bd1e995U;
    axes.push_back({.part = part,
                    .spread = static_cast<float>(spread),
                    .lowest = static_cast<float>(lowest),
                    .highest = static_cast<float>(highest),
                    .change = static_cast<float>(rate * settings.period),
                    .noise = ColouredNoise(settings.rollouts, correlation(settings), seed)});
  };
  add(&DriveCommand::v, settings.speed_std, limits.lowest_speed, limits.highest_speed, limits.acceleration);
  add(&DriveCommand::omega, settings.yaw_rate_std, -limits.yaw_rate, limits.yaw_rate, limits.yaw_acceleration);
  if (sideways) {
    add(&DriveCommand::vy, settings.sideways_std, -limits.sideways_speed, limits.sideways_speed,
        limits.sideways_acceleration);
  }
  return axes;
}

/// Adds noise to the planned value, within its range and within its change from the value before.
void sample_period(const MppiAxis& axis, float planned, std::span<const float> noise, const float* before, float* out) {
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const float low = std::max(axis.lowest, before[i] - axis.change);
    const float high = std::min(axis.highest, before[i] + axis.change);
    out[i] = std::min(std::max(planned + axis.spread * noise[i], low), high);
  }
}

float map_value(const Costmap& map, const Pose2& pose) {
  const double column = std::floor((pose.x - map.origin_x) / map.resolution);
  const double row = std::floor((pose.y - map.origin_y) / map.resolution);
  const bool inside =
      column >= 0.0 && row >= 0.0 && column < static_cast<double>(map.columns) && row < static_cast<double>(map.rows);
  return inside ? map.cells[static_cast<std::size_t>(row) * map.columns + static_cast<std::size_t>(column)]
                : map.outside;
}

}  // namespace

void MppiSettings::check() const {
  need(rollouts >= 2 && periods >= 2 && rollouts * periods <= 100'000'000, "give 2 rollouts and 2 periods or more");
  need(positive(period), "the period must be positive seconds");
  need(positive(speed_std) && positive(yaw_rate_std) && positive(sideways_std) && not_negative(colour),
       "the noise must be positive");
  need(positive(temperature), "the temperature must be positive");
  need(risk >= 0.0 && risk <= 1.0, "the risk must lie between 0 and 1");
  need(std::isfinite(limits.lowest_speed) && std::isfinite(limits.highest_speed) &&
           limits.lowest_speed < limits.highest_speed,
       "the lowest speed must lie below the highest");
  need(positive(limits.yaw_rate) && positive(limits.acceleration) && positive(limits.yaw_acceleration) &&
           positive(limits.sideways_speed) && positive(limits.sideways_acceleration),
       "the limits must be positive");
  for (const double cost :
       {costs.across, costs.along, costs.heading, costs.smoothness, costs.obstacle, costs.collision}) {
    need(not_negative(cost), "a cost must not be negative");
  }
}

Mppi::Mppi(std::vector<RolloutProgram> models, const MppiSettings& settings, std::optional<CarCurves> car)
    : models_(std::move(models)),
      settings_((settings.check(), settings)),
      car_(std::move(car)),
      axes_((check_models(models_, settings_), axes_of(settings_, models_.front().sideways()))),
      plan_(settings.periods),
      cost_(settings.rollouts),
      mean_(settings.rollouts),
      worst_(settings.rollouts),
      free_(settings.rollouts),
      map_sum_(settings.rollouts),
      map_highest_(settings.rollouts) {
  need(!(car_ && models_.front().sideways()), "a car commanded by throttle and steering does not drive sideways");
  for (auto* values : {&x_, &y_, &theta_}) {
    values->resize(settings_.rollouts * settings_.periods);
  }
  for (MppiAxis& axis : axes_) {
    axis.values.resize(settings_.rollouts * settings_.periods);
  }
}

void Mppi::adopt(std::vector<RolloutProgram> models, std::optional<CarCurves> car) {
  check_models(models, settings_);
  need(car.has_value() == car_.has_value(), "models of throttle and steering do not take the place of others");
  need(models.front().sideways() == models_.front().sideways(),
       "models that drive sideways do not take the place of others");
  car_ = std::move(car);
  models_ = std::move(models);
}

void Mppi::reset(const DriveCommand& command) {
  std::ranges::fill(plan_, command);
  planned_ = true;
}

void Mppi::sample(const DriveCommand& last) {
  const std::size_t count = settings_.rollouts;
  std::vector<float> noise(count);
  for (MppiAxis& axis : axes_) {
    const std::vector<float> sent(count, static_cast<float>(last.*axis.part));
    const float* before = sent.data();
    axis.noise.begin();
    for (std::size_t k = 0; k < settings_.periods; ++k) {
      noise = axis.noise.next();
      noise[0] = 0.0F;  // the plan itself is one of the rollouts
      float* const out = axis.values.data() + k * count;
      sample_period(axis, static_cast<float>(plan_[k].*axis.part), noise, before, out);
      before = out;
    }
  }
}

void Mppi::drive(const RolloutProgram& model, const MppiState& state, const MppiReference& reference,
                 const Costmap* map) {
  const std::size_t count = settings_.rollouts;
  RolloutBatch<float> batch{
      .rollouts = count,
      .periods = settings_.periods,
      .commands = {axes_[0].values.data(), axes_[1].values.data(), 1, static_cast<std::ptrdiff_t>(count),
                   axes_.size() > 2 ? axes_[2].values.data() : nullptr},
      .starts = {&state.start, 1},
      .past = state.past};
  CarBatch<float> twists;
  if (car_) {
    twists = car_batch(*car_, batch, settings_.period);
    batch.commands = {twists.v.data(), twists.omega.data(), 1, static_cast<std::ptrdiff_t>(count)};
    batch.past = twists.past;
  }
  const RolloutOutputs<float> outputs{.x = x_.data(),
                                      .y = y_.data(),
                                      .theta = theta_.data(),
                                      .map = map,
                                      .cost_sum = map == nullptr ? nullptr : map_sum_.data(),
                                      .cost_highest = map == nullptr ? nullptr : map_highest_.data()};
  rollout_batch(model, batch, outputs);
  std::ranges::fill(cost_, 0.0F);
  add_tracking(reference);
  if (map != nullptr) {
    const auto per_value = static_cast<float>(settings_.costs.obstacle * settings_.period);
    const auto lethal = static_cast<float>(settings_.costs.lethal);
    const auto collision = static_cast<float>(settings_.costs.collision);
    for (std::size_t i = 0; i < count; ++i) {
      const bool hit = map_highest_[i] >= lethal;
      cost_[i] += per_value * map_sum_[i] + (hit ? collision : 0.0F);
      free_[i] = hit ? 0 : free_[i];
    }
  }
}

void Mppi::add_tracking(const MppiReference& reference) {
  const std::size_t count = settings_.rollouts;
  const auto across = static_cast<float>(settings_.costs.across * settings_.period);
  const auto along = static_cast<float>(settings_.costs.along * settings_.period);
  const auto heading = static_cast<float>(settings_.costs.heading * settings_.period);
  float* const cost = cost_.data();
  for (std::size_t k = 0; k < settings_.periods; ++k) {
    const float* const x = x_.data() + k * count;
    const float* const y = y_.data() + k * count;
    const float* const theta = theta_.data() + k * count;
    const float rx = reference.x[k], ry = reference.y[k], rt = reference.theta[k];
    const float c = std::cos(rt), s = std::sin(rt);
    for (std::size_t i = 0; i < count; ++i) {
      const float dx = x[i] - rx, dy = y[i] - ry, turn = theta[i] - rt;
      const float ahead = c * dx + s * dy, beside = c * dy - s * dx;
      cost[i] += across * beside * beside + along * ahead * ahead + heading * turn * turn;
    }
  }
}

void Mppi::add_smoothness(const DriveCommand& last) {
  const std::size_t count = settings_.rollouts;
  const auto weight = static_cast<float>(settings_.costs.smoothness);
  float* const cost = cost_.data();
  for (const MppiAxis& axis : axes_) {
    const std::vector<float> sent(count, static_cast<float>(last.*axis.part));
    const float per_change = 1.0F / axis.change;
    for (std::size_t k = 0; k < settings_.periods; ++k) {
      const float* const now = axis.values.data() + k * count;
      const float* const before = k == 0 ? sent.data() : now - count;
      for (std::size_t i = 0; i < count; ++i) {
        const float change = (now[i] - before[i]) * per_change;
        cost[i] += weight * (change * change);
      }
    }
  }
}

MppiResult Mppi::average() {
  const std::size_t count = settings_.rollouts;
  const float best = *std::ranges::min_element(cost_);
  // A quantile, since collisions would spoil a mean.
  std::ranges::copy(cost_, mean_.begin());
  const auto quarter = mean_.begin() + static_cast<std::ptrdiff_t>(count / 4);
  std::ranges::nth_element(mean_, quarter);
  const double scale = settings_.temperature * (*quarter - best);
  double sum = 0.0, squares = 0.0;
  for (float& cost : cost_) {
    cost = scale > 0.0 ? static_cast<float>(std::exp((best - cost) / scale)) : 1.0F;
    sum += cost;
    squares += static_cast<double>(cost) * cost;
  }
  for (const MppiAxis& axis : axes_) {
    for (std::size_t k = 0; k < settings_.periods; ++k) {
      const float* const values = axis.values.data() + k * count;
      float mean = 0.0F;
      for (std::size_t i = 0; i < count; ++i) {
        mean += cost_[i] * values[i];
      }
      plan_[k].*axis.part = mean / sum;
    }
  }
  return {.command = plan_.front(), .plan = plan_, .best_cost = best, .effective = sum * sum / squares};
}

MppiResult Mppi::step(const MppiState& state, const MppiReference& reference, const Costmap* map) {
  const std::size_t periods = settings_.periods;
  need(reference.x.size() == periods && reference.y.size() == periods && reference.theta.size() == periods,
       "the reference must have one pose per period");
  for (const auto* values : {&reference.x, &reference.y, &reference.theta}) {
    need(std::ranges::all_of(*values, [](float value) { return std::isfinite(value); }), "the reference is not finite");
  }
  if (map != nullptr) {
    check_costmap(*map);
    need(map_value(*map, state.start.pose) < settings_.costs.lethal,
         "the robot starts inside an obstacle; free it first, or check its pose and the map");
  }
  const DriveCommand unsent = car_ ? DriveCommand{} : state.start.drive;
  const DriveCommand last = state.past.empty() ? unsent : state.past.back();
  if (planned_) {
    std::ranges::rotate(plan_, plan_.begin() + 1);
    plan_.back() = plan_[periods - 2];
  } else {  // a moving robot goes on as it was commanded
    reset(last);
  }
  sample(last);
  std::ranges::fill(mean_, 0.0F);
  std::ranges::fill(worst_, 0.0F);
  std::ranges::fill(free_, 1);
  const auto fraction = static_cast<float>(1.0 / static_cast<double>(models_.size()));
  for (const RolloutProgram& model : models_) {
    drive(model, state, reference, map);
    for (std::size_t i = 0; i < settings_.rollouts; ++i) {
      mean_[i] += fraction * cost_[i];
      worst_[i] = std::max(worst_[i], cost_[i]);
    }
  }
  const auto risk = static_cast<float>(settings_.risk);
  for (std::size_t i = 0; i < settings_.rollouts; ++i) {
    cost_[i] = (1.0F - risk) * mean_[i] + risk * worst_[i];
  }
  add_smoothness(last);
  MppiResult result = average();
  result.collides = std::ranges::find(free_, 1) == free_.end();
  return result;
}

}  // namespace slipwise
