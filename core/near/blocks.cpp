#include "near/blocks.hpp"

#include <algorithm>
#include <bit>

#include "numbers/arithmetic.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// g++ 12.2 makes fused operations of sums of products that it finds side by side, though
// -ffp-contract=off forbids them.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress::near {
namespace {

std::vector<double> sines_of(int length) {
  const auto n = static_cast<std::size_t>(length);
  std::vector<double> turn(2 * n), table((n - 1) * (n - 1));
  const double height = std::sqrt(2.0 / length);
  for (std::size_t i = 0; i < 2 * n; ++i) {
    turn[i] = height * sine_cosine(3.141592653589793 * static_cast<double>(i) / length).sine;
  }
  for (std::size_t k = 1; k < n; ++k) {
    for (std::size_t t = 1; t < n; ++t) table[(k - 1) * (n - 1) + t - 1] = turn[k * t % (2 * n)];
  }
  return table;
}

template <int kLength>
const std::vector<double>& table() {
  static const std::vector<double> kSines = sines_of(kLength);
  return kSines;
}

const std::vector<double>& table_of(int length) {
  switch (length) {
    case 8:
      return table<8>();
    case 16:
      return table<16>();
    case 32:
      return table<32>();
    case 64:
      return table<64>();
    case 128:
      return table<128>();
    default:
      return table<256>();
  }
}

}  // namespace

std::span<const double> sine(int length, int k) {
  const auto width = static_cast<std::size_t>(length - 1);
  return std::span(table_of(length)).subspan(static_cast<std::size_t>(k - 1) * width, width);
}

double step_of(int exponent) {
  double step = 1, root = 2;
  for (int bit = 32; bit > 0; bit /= 2) {
    root = std::sqrt(root);
    if ((exponent & bit) != 0) step = step * root;
  }
  return std::ldexp(step, exponent >> 6);
}

void draw(const Block& block, double left, double step, const Plan& plan, double* curve) {
  const int n = block.length;
  const double knot = block.numbers[0] * (step * plan.knot);
  for (int t = 1; t <= n; ++t) curve[t - 1] = left + knot * t / n;
  const int end = end_of(block.of_class, n);
  std::size_t state = 0;
  for (int k = 1; k <= end; ++k) {
    const std::int32_t number = block.numbers[k];
    const bool odd = is_odd(state);
    state = next_state(state, number);
    if (number == 0) continue;
    const double height = height_of(number, odd) * step;
    const double* const wave = sine(n, k).data();
    for (int t = 0; t < n - 1; ++t) curve[t] += wave[t] * height;
  }
}

}  // namespace mocapress::near
