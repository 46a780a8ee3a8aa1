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
  }
}

float correlation(const MppiSettings& settings) {
  return settings.colour > 0.0 ? static_cast<float>(std::exp(-settings.period / settings.colour)) : 0.0F;
}

/// Adds noise to the planned value, within its range and within its change from the value before.
struct CommandSampler {
  float planned, spread, lowest, highest, change;

  void run(const float* noise, const float* before, float* out, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
      const float low = std::max(lowest, before[i] - change);
      const float high = std::min(highest, before[i] + change);
      out[i] = std::min(std::max(planned + spread * noise[i], low), high);
    }
  }
};

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
  need(positive(speed_std) && positive(yaw_rate_std) && not_negative(colour), "the noise must be positive");
  need(positive(temperature), "the temperature must be positive");
  need(risk >= 0.0 && risk <= 1.0, "the risk must lie between 0 and 1");
  need(std::isfinite(limits.lowest_speed) && std::isfinite(limits.highest_speed) &&
           limits.lowest_speed < limits.highest_speed,
       "the lowest speed must lie below the highest");
  need(positive(limits.yaw_rate) && positive(limits.acceleration) && positive(limits.yaw_acceleration),
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
      noise_v_(settings.rollouts, correlation(settings), settings.seed),
      noise_omega_(settings.rollouts, correlation(settings), settings.seed + 0x5bd1e995U),
      plan_(settings.periods),
      cost_(settings.rollouts),
      mean_(settings.rollouts),
      worst_(settings.rollouts),
      free_(settings.rollouts),
      map_sum_(settings.rollouts),
      map_highest_(settings.rollouts) {
  check_models(models_, settings_);
  for (auto* values : {&v_, &omega_, &x_, &y_, &theta_}) {
    values->resize(settings_.rollouts * settings_.periods);
  }
}

void Mppi::adopt(std::vector<RolloutProgram> models, std::optional<CarCurves> car) {
  check_models(models, settings_);
  need(car.has_value() == car_.has_value(), "models of throttle and steering do not take the place of others");
  car_ = std::move(car);
  models_ = std::move(models);
}

void Mppi::reset(const DriveCommand& command) {
  std::ranges::fill(plan_, command);
  planned_ = true;
}

void Mppi::sample(const DriveCommand& last) {
  const std::size_t count = settings_.rollouts;
  const MppiLimits& limits = settings_.limits;
  CommandSampler speed{.planned = 0.0F,
                       .spread = static_cast<float>(settings_.speed_std),
                       .lowest = static_cast<float>(limits.lowest_speed),
                       .highest = static_cast<float>(limits.highest_speed),
                       .change = static_cast<float>(limits.acceleration * settings_.period)};
  CommandSampler turn{.planned = 0.0F,
                      .spread = static_cast<float>(settings_.yaw_rate_std),
                      .lowest = static_cast<float>(-limits.yaw_rate),
                      .highest = static_cast<float>(limits.yaw_rate),
                      .change = static_cast<float>(limits.yaw_acceleration * settings_.period)};
  std::vector<float> before_v(count, static_cast<float>(last.v));
  std::vector<float> before_omega(count, static_cast<float>(last.omega));
  const float* from_v = before_v.data();
  const float* from_omega = before_omega.data();
  std::vector<float> noise(count);
  noise_v_.begin();
  noise_omega_.begin();
  for (std::size_t k = 0; k < settings_.periods; ++k) {
    speed.planned = static_cast<float>(plan_[k].v);
    turn.planned = static_cast<float>(plan_[k].omega);
    const auto drawn = [&](ColouredNoise& from) {
      noise = from.next();
      noise[0] = 0.0F;  // the plan itself is one of the rollouts
      return noise.data();
    };
    speed.run(drawn(noise_v_), from_v, v_.data() + k * count, count);
    turn.run(drawn(noise_omega_), from_omega, omega_.data() + k * count, count);
    from_v = v_.data() + k * count;
    from_omega = omega_.data() + k * count;
  }
}

void Mppi::drive(const RolloutProgram& model, const MppiState& state, const MppiReference& reference,
                 const Costmap* map) {
  const std::size_t count = settings_.rollouts;
  RolloutBatch<float> batch{.rollouts = count,
                            .periods = settings_.periods,
                            .commands = {v_.data(), omega_.data(), 1, static_cast<std::ptrdiff_t>(count)},
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
  const MppiLimits& limits = settings_.limits;
  const auto weight = static_cast<float>(settings_.costs.smoothness);
  const auto per_v = static_cast<float>(1.0 / (limits.acceleration * settings_.period));
  const auto per_omega = static_cast<float>(1.0 / (limits.yaw_acceleration * settings_.period));
  const std::vector<float> last_v(count, static_cast<float>(last.v)), last_omega(count, static_cast<float>(last.omega));
  float* const cost = cost_.data();
  for (std::size_t k = 0; k < settings_.periods; ++k) {
    const float* const v = v_.data() + k * count;
    const float* const omega = omega_.data() + k * count;
    const float* const before_v = k == 0 ? last_v.data() : v - count;
    const float* const before_omega = k == 0 ? last_omega.data() : omega - count;
    for (std::size_t i = 0; i < count; ++i) {
      const float dv = (v[i] - before_v[i]) * per_v, domega = (omega[i] - before_omega[i]) * per_omega;
      cost[i] += weight * (dv * dv + domega * domega);
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
  for (std::size_t k = 0; k < settings_.periods; ++k) {
    const float* const v = v_.data() + k * count;
    const float* const omega = omega_.data() + k * count;
    float mean_v = 0.0F, mean_omega = 0.0F;
    for (std::size_t i = 0; i < count; ++i) {
      mean_v += cost_[i] * v[i];
      mean_omega += cost_[i] * omega[i];
    }
    plan_[k] = {.v = mean_v / sum, .omega = mean_omega / sum};
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
