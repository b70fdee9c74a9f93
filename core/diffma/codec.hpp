// DiffMA (T.-Y. Nagao, "DiffMA: A Lossy Encoding of Motion Capture Data for JSON", 2021): one
// channel as opcodes, one or two ASCII characters each, and a look-up table.
// docs/guide/diffma_json.md lays down every rounding; encoder and decoder share them bit for bit.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mocapress::diffma {

inline constexpr int kMostBits = 12;
inline constexpr int kMostOrder = 7;

// What encoder and decoder share.
struct Parameters {
  int bits;            // n
  std::size_t window;  // w, at least 1
  double bound;        // beta
  int order;           // of the predictor; 0 is the published algorithm
};

// What only the encoder needs.
struct Limits {
  double tolerance;     // tau: APX errors stay below
  double round_offset;  // 1/2 in Eq. 2.2
  double max_error;     // APX errors do not exceed
  // Past the paper: no NEG where no sign is used, and EQL for APX(0), which decodes to the same.
  bool spare_signs;
};

struct Record {
  std::string opcodes;        // b
  std::vector<double> table;  // t
  double squared_error = 0;   // sum over all samples that are numbers
};

// Algorithm 1. Any values: what is no number, and what follows it, goes to the table.
Record encode(std::span<const double> values, const Parameters& parameters, const Limits& limits);

enum class Fault { none, alphabet, opcode, cut_off };

// What a string of opcodes asks for, without decoding it.
struct Scan {
  std::size_t steps = 0;  // values behind the first
  std::size_t raws = 0;   // numbers of the table behind the first
  Fault fault = Fault::none;
  std::size_t fault_at = 0;  // character at which it stands
};
Scan scan(std::string_view opcodes, int bits);

// Algorithm 2. Throws std::invalid_argument where opcodes, table and number of values do not agree.
void decode(std::string_view opcodes, std::span<const double> table, const Parameters& parameters,
            std::span<double> values);

}  // namespace mocapress::diffma
