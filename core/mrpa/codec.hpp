// Coding motion beside what it resembles: pieces of a clip, each predicted from itself and, where
// it has one, from its parent, frame by frame (Section III-D of the MRPA paper). What predictions
// miss is coded by APP's floating-point compression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/codec.hpp"
#include "coding/bit.hpp"

namespace mocapress::mrpa {

struct Piece {
  std::size_t frames;
  bool parent;  // whether it has one
  bool fresh;   // whether it is predicted without the frames before it
};

enum class Choice : std::uint8_t {
  published,  // pieces with a parent: neighbouring residuals; others without prediction
  previous,   // the same, but others are predicted by the frame before
  best,       // for each column of a piece what is estimated to be shortest
};

// A chunk to be coded: rows of values and, beside each, the row of the parent; those of pieces that
// have none are not looked at.
struct Rows {
  const double* values;
  const double* parents;
  std::span<const Piece> pieces;
  std::span<const app::Column> columns;
};

Bytes encode(const Rows& rows, int mantissa_limit, Choice choice);

// The inverse: fills `values`. `parents` may be null where no piece has one. Throws
// std::invalid_argument where `payload` is not what `encode` makes of such pieces.
void decode(ByteView payload, double* values, const double* parents, std::span<const Piece> pieces,
            std::span<const app::Column> columns, int mantissa_limit);

// What `Choice::best` takes: of each column and each piece alpha and beta, by their numbers.
std::vector<std::uint8_t> weights_of(const Rows& rows);

// About how many bits each piece takes without its parent and with it, by turns.
std::vector<double> estimated_bits(const Rows& rows);

}  // namespace mocapress::mrpa
