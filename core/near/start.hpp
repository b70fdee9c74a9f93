// What coders begin with, learned from motion of the CMU database: benchmarks/near_start.py makes
// it, and docs/format/near.md says how it is written.
#pragma once

#include <cstddef>
#include <vector>

#include "coding/bit.hpp"
#include "near/blocks.hpp"
#include "near/coder.hpp"
#include "near/prediction.hpp"

namespace mocapress::near {

struct Start {
  Models models;
  std::vector<Assumed> assumed;    // by channel and source
  std::uint64_t observations = 0;  // that these are worth
};

inline constexpr int kStarts = 3;  // for fine, middling and coarse scales

// The shipped ones. Of what goes by channels they have only what is learned of the known figure,
// and nothing where the figure is not `known`.
const Start& start_of(int index, bool known);

// The figure whose channels are known: that of the CMU database.
struct Figure {
  std::vector<int> exponents;  // of the columns' steps, beside that of the clip
  Joints joints;
  std::vector<Turning> turnings;
  std::vector<double> firsts;
};

const Figure& known_figure();

Bytes pack(Start& start);
Start unpack(ByteView packed, bool known);

}  // namespace mocapress::near
