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

// How columns stand in the header: for each, by how many times 32/64 octaves its step is above that
// of the column before, and its joint.
template <class Side>
void code_columns(Side& side, std::vector<std::int64_t>& apart, Joints& joints) {
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
}

// The codec header, of so many columns. `fail`s where it is none.
Plan read_header(ByteView header, std::size_t columns);

// What channels that are to begin are predicted by.
Prediction prediction_of(const Coder& coder, const Plan& plan);

// Fills frames x columns values, row by row. `fail`s where the payload is none of so many.
void decode(ByteView payload, double* values, std::size_t frames, const Plan& plan);

}  // namespace mocapress::near
