// The codec `near`: docs/format/near.md. Decoding, which the page does, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coding/bit.hpp"
#include "coding/numbers.hpp"
#include "near/blocks.hpp"
#include "near/coder.hpp"
#include "near/prediction.hpp"

namespace mocapress::near {

// Which joints' last three columns are angles whose curves turn in another order.
template <class Side>
void code_turnings(Side& side, const Joints& joints, std::vector<Turning>& turnings) {
  Bit turned[2], nearest[2];
  BitTree<3> columns, axes, curves;
  const std::size_t count = joints.of_column.size();
  std::size_t begin = 0, next = 0;
  bool last = false;
  for (std::size_t c = 1; c <= count; ++c) {
    if (c < count && joints.of_column[c] == joints.of_column[begin]) continue;
    const std::size_t own = c - begin;
    begin = c;
    if (own < 3) continue;
    const bool given = next < turnings.size() && turnings[next].first == c - 3;
    last = side.bit(turned[last ? 1 : 0], given);
    if (!last) continue;
    if (Side::kReading) turnings.push_back({c - 3});
    Turning& turning = turnings[next++];
    const auto order = [&](BitTree<3>& tree, std::uint8_t& value) {
      value = static_cast<std::uint8_t>(tree.code(side, value));
      if (value >= kOrders.size()) {
        side.fail();
        value = 0;
      }
    };
    order(columns, turning.columns);
    order(axes, turning.axes);
    order(curves, turning.curves);
    turning.nearest_to_zero = side.bit(nearest[0], turning.nearest_to_zero);
  }
}

// For each column a number that is 0 for most: by how many times 32/64 octaves its step is finer
// than that of the known figure, beyond the column before; or how many columns of the file it
// skips.
template <class Side>
void code_differences(Side& side, std::vector<std::int64_t>& apart) {
  Difference<6> differences;
  for (std::int64_t& each : apart) each = differences.code(side, each);
}

// How columns stand in the header: for each, by how many times 32/64 octaves its step is above that
// of the column before, and its joint; then which joints' curves turn in another order.
template <class Side>
void code_columns(Side& side, std::vector<std::int64_t>& apart, Joints& joints,
                  std::vector<Turning>& turnings) {
  Difference<7> differences;
  Bit again[2];
  Count parents;
  bool same = false;
  for (std::size_t c = 0; c < apart.size(); ++c) {
    apart[c] = differences.code(side, apart[c]);
    std::int32_t& joint = joints.of_column[c];
    const std::int32_t before = c > 0 ? joints.of_column[c - 1] : -1;
    same = c > 0 && side.bit(again[same ? 1 : 0], joint == before);
    if (same) {
      joint = before;
      continue;
    }
    joint = before + 1;
    if (Side::kReading) joints.parents.push_back(-1);
    std::int32_t& parent = joints.parents[static_cast<std::size_t>(joint)];
    const auto most = static_cast<std::uint64_t>(joint);
    const auto back =
        parents.code(side, static_cast<std::uint64_t>(parent < 0 ? 0 : joint - parent));
    if (back > most) side.fail();
    parent = back == 0 || back > most ? -1 : joint - static_cast<std::int32_t>(back);
  }
  code_turnings(side, joints, turnings);
}

// The codec header, of so many columns. `fail`s where it is none.
Plan read_header(ByteView header, std::size_t columns);

// What channels that are to begin are predicted by.
Prediction prediction_of(const Coder& coder, const Plan& plan);

// Makes the file's angles of the curves' in frames x columns values; `starts` has for each turning
// what those of the first frame are near to.
void turn_back(double* values, std::size_t frames, const Plan& plan,
               const std::vector<Angles>& starts);

// Where the file's angles begin, in eighths of a turn; nothing of those nearest to zero.
template <class Side>
std::vector<Angles> code_starts(Side& side, const Plan& plan, const std::vector<Angles>& given) {
  Difference<6> eighths;
  std::vector<Angles> starts(plan.turnings.size());
  const double eighth = plan.radians ? 0.7853981633974483 : 45;
  for (std::size_t t = 0; t < starts.size(); ++t) {
    if (plan.turnings[t].nearest_to_zero) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto number = Side::kReading ? 0 : static_cast<std::int64_t>(given[t][i] / eighth);
      starts[t][i] = static_cast<double>(eighths.code(side, number)) * eighth;
    }
  }
  return starts;
}

// Fills frames x columns values, row by row. `fail`s where the payload is none of so many.
void decode(ByteView payload, double* values, std::size_t frames, const Plan& plan);

}  // namespace mocapress::near
