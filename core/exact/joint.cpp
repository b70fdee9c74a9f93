#include "exact/joint.hpp"

#include <algorithm>
#include <cmath>

#include "numbers/arithmetic.hpp"

namespace mocapress::exact {
namespace {

constexpr double kShapes = 27 * 9;
constexpr double kLoosest = 1000;
constexpr double kBlind = 1e-12;  // below, the target's turn moves nothing

// `vector` turned about an axis by an angle in degrees.
Vector turned(std::size_t axis, double angle, Vector vector) {
  const auto [sine, cosine] = sine_cosine(angle * kRadiansPerDegree);
  double& y = vector[(axis + 1) % 3];
  double& z = vector[(axis + 2) % 3];
  const double moved = y * cosine - z * sine;
  z = y * sine + z * cosine;
  y = moved;
  return vector;
}

}  // namespace

bool Joint::exists(std::size_t sources, std::span<const double> parameters) {
  if (sources < 1 || sources > 2 || parameters.size() != kParameters) return false;
  const double shape = parameters[0];
  if (!(shape >= 0 && shape < kShapes) || shape != std::floor(shape)) return false;
  const int turns = static_cast<int>(shape) / 27;
  if (turns % 3 == turns / 3) return false;
  return std::ranges::all_of(parameters.subspan(1),
                             [](double p) { return std::fabs(p) <= 2 * kLargest; });
}

Joint::Joint(std::size_t sources, std::span<const double> parameters)
    : sources_(sources),
      u_{parameters[1], parameters[2], parameters[3]},
      v_{parameters[4], parameters[5], parameters[6]},
      c_(parameters[7]) {
  auto shape = static_cast<std::size_t>(parameters[0]);
  for (auto& axis : axes_) {
    axis = shape % 3;
    shape /= 3;
  }
  target_ = shape % 3;
  places_ = {shape / 3, 3 - target_ - shape / 3};
  length_ = std::sqrt(dot(u_, u_) * dot(v_, v_));
}

Joint::Angles Joint::angles(const double* sources, double unknown) const {
  Vector known{};
  for (std::size_t i = 0; i < sources_; ++i) known[places_[i]] = sources[i];
  Vector left = u_;
  for (std::size_t i = 0; i < target_; ++i) left = turned(axes_[i], -known[i], left);
  Vector right = v_;
  for (std::size_t i = 2; i > target_; --i) right = turned(axes_[i], known[i], right);
  const std::size_t x = axes_[target_];
  const std::size_t y = (x + 1) % 3;
  const std::size_t z = (x + 2) % 3;
  const double a = left[y] * right[y] + left[z] * right[z];
  const double b = left[z] * right[y] - left[y] * right[z];
  const double size = std::sqrt(a * a + b * b);
  if (!(size > kBlind)) return {unknown, unknown, kLoosest};
  const double cosine = std::clamp((c_ - left[x] * right[x]) / size, -1.0, 1.0);
  const double middle = arc_tangent(b, a) / kRadiansPerDegree;
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  const double away = arc_tangent(sine, cosine) / kRadiansPerDegree;
  return {middle - away, middle + away, length_ / std::max(size * sine, length_ / kLoosest)};
}

}  // namespace mocapress::exact
