// The decimal grid of a column: the number that stands in the text for a float near it.
#pragma once

#include <cstdint>

namespace mocapress {

// The kinds of mocapress.motion.NumberFormat, of which SCIENTIFIC is GENERAL with one digit more.
enum class Grid : std::uint8_t { none, significant, decimals, shortest32 };

// The double nearest to the decimal number of `digits` significant digits or decimals next to
// `value` (shortest32: of the fewest digits that name this float32). Keeps -0, infinities, NaN and
// whatever the grid has no exact number for.
double snap(double value, Grid grid, int digits);

}  // namespace mocapress
