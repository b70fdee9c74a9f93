// Joints whose curves are angles of another order than the file's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mocapress::near {

// Three numbers from 0 to 2, and the six ways to put them.
using Order = std::array<std::uint8_t, 3>;
inline constexpr std::array<Order, 6> kOrders = {
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

// A joint of three angles in the columns `first` on. Turns are told from the outermost on.
struct Turning {
  std::size_t first;
  std::uint8_t columns = 0;  // of the file's turns, counted from `first`: one of kOrders
  std::uint8_t axes = 0;     // about which these turn
  std::uint8_t curves = 0;   // about which the curves turn, in the order of columns
  // Whether the file's angles are those nearest to 0 in every frame, or to those of the frame
  // before.
  bool nearest_to_zero = false;
};

using Angles = std::array<double, 3>;

// From the file's angles to the curves'; `last` are these in the frame before.
Angles to_curves(const Turning& turning, bool radians, const Angles& file, const Angles& last);
// And back, in rows of so many columns; `last` are the file's in the frame before the first.
void to_file(const Turning& turning, bool radians, double* rows, std::size_t columns,
             std::size_t frames, Angles last);

}  // namespace mocapress::near
