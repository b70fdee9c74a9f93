// Number formats between Python and numbers/text.hpp: the four bytes of docs/format/layout.md.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "numbers/text.hpp"
#include "python/bindings.hpp"

namespace mocapress {

using Formats = Plan<std::uint8_t, 4>;

inline NumberFormat number_format(const std::uint8_t* f) {
  if (f[0] > 5 || f[1] > kMostDigits || f[2] > 8 || (f[0] == 0 && (f[1] < 1 || f[1] > 17)))
    throw nb::value_error("no such number format");
  const auto flag = [f](unsigned bit) { return (f[3] >> bit & 1) != 0; };
  return {static_cast<NumberKind>(f[0]),
          f[1],
          f[2],
          flag(0),
          flag(1),
          flag(2),
          flag(3),
          flag(4),
          flag(5),
          flag(6),
          flag(7)};
}

inline std::vector<NumberFormat> number_formats(const Formats& formats) {
  std::vector<NumberFormat> list(formats.shape(0));
  for (std::size_t c = 0; c < list.size(); ++c) list[c] = number_format(formats.data() + 4 * c);
  return list;
}

inline Given<std::uint8_t, 2> packed(const std::vector<NumberFormat>& formats) {
  std::vector<std::uint8_t> bytes;
  for (const NumberFormat& f : formats) {
    const unsigned flags = f.point_zero | f.bare_point << 1 | f.upper << 2 | f.plus << 3 |
                           f.zeros << 4 | f.end_point << 5 | f.java << 6 | f.javascript << 7;
    bytes.insert(bytes.end(), {static_cast<std::uint8_t>(f.kind), f.digits, f.exponent_digits,
                               static_cast<std::uint8_t>(flags)});
  }
  return give(std::move(bytes), std::array{formats.size(), std::size_t{4}});
}

}  // namespace mocapress
