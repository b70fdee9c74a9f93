// The codec `exact`: every number is coded as its place on the line of numbers that its column can
// hold, beside a prediction blended from several predictors that learn as they go. docs/exact.md
// explains the model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coding/bit.hpp"
#include "numbers/line.hpp"

namespace mocapress::exact {

struct Column {
  Line line;
  int digits;
  bool noise;      // rounding noise around zero, which nothing predicts; such columns come last
  int exponent;    // numbers are multiplied by 2^exponent before they are predicted
  int turns;       // 1, 2: degrees from -180, from 0 on that jump by whole turns; else 0
  int place = -1;  // among the channels of the skeleton of exact/kinematics.hpp, or none
};

// Columns that are functions of others in the same frame.
struct Coupling {
  int kind;  // 0: a polynomial of degree 3, learned as it goes; else a LawKind or Joint::kKind
  std::vector<std::uint16_t> sources;
  std::vector<std::uint16_t> targets;  // behind the sources, in ascending order
  std::vector<double> parameters;      // of a joint
};

// What a coder has learned, for another to begin with.
struct Start {
  std::vector<float> shared;                // by all columns; empty: nothing
  std::vector<std::vector<float>> columns;  // by each column; empty, or not of its size: nothing
};

struct Clip {
  std::span<const Column> columns;
  std::span<const Coupling> couplings;
  int level;  // 1 to kStrongest
  const Start& start;
};

// Codes `frames` x columns.size() values, row by row, as one chunk that needs no other. Where
// `learned` is given, it is filled with what the coder knows in the end.
//
// Where `seen` is given, what the network of levels from 7 on sees of each number is added to it.
// Where `early` is given, it becomes about how many bytes the first kEarly frames take; 0 up to
// level 5.
Bytes encode(const double* values, std::size_t frames, const Clip& clip, Start* learned = nullptr,
             std::vector<float>* seen = nullptr, std::size_t* early = nullptr);

inline constexpr std::size_t kEarly = 256;

// At which clips are coded that level 9 was asked for; 9 itself is that of older files.
inline constexpr int kStrongest = 10;
inline constexpr int kUsualLevel = 5;  // that of files which name none, as in Python and the page

inline constexpr std::size_t kTogether = 1024;  // columns of a part, at most

// The inverse. Throws std::invalid_argument when `payload` is not what `encode` makes.
//
// Unless `whole`, these are only the chunk's first frames, and what is behind them is not read; of
// more than kTogether columns all frames must be asked for.
void decode(ByteView payload, double* values, std::size_t frames, const Clip& clip,
            bool whole = true);

}  // namespace mocapress::exact
