#include "numbers/powers.hpp"

#include <charconv>

namespace mocapress {
namespace {

using Powers = std::array<double, kHighestPower - kLowestPower + 1>;

Powers make_powers() {
  Powers powers{};
  for (std::size_t i = 0; i < powers.size(); ++i) {
    std::array<char, 8> text{'1', 'e'};
    char* const last = text.data() + text.size();
    const auto end = std::to_chars(text.data() + 2, last, static_cast<int>(i) + kLowestPower);
    std::from_chars(text.data(), end.ptr, powers[i]);
  }
  return powers;
}

}  // namespace

const Powers kPowersOfTen = make_powers();

}  // namespace mocapress
