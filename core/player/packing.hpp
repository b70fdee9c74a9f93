// Packed content: docs/format.md, "Packed content".
#pragma once

#include <cstddef>

#include "coding/bit.hpp"
#include "coding/record.hpp"

namespace mocapress::player {

// Takes what is left of a record, of which at most so many bytes come out.
Bytes unpack(Record record, std::size_t most);

}  // namespace mocapress::player
