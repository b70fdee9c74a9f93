#include "diffma/codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "coding/fail.hpp"

namespace mocapress::diffma {
namespace {

// Eq. 3.1; APX(q) is kApx + q.
constexpr unsigned kNeg = 0, kRaw = 1, kEql = 2, kApx = 3;
constexpr std::string_view kAlphabet =
    "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~";
constexpr unsigned kSymbols = kAlphabet.size();
constexpr unsigned kNoSymbol = 255;

constexpr auto kSymbolOf = [] {
  std::array<std::uint8_t, 256> table{};
  table.fill(kNoSymbol);
  for (unsigned i = 0; i < kSymbols; ++i) {
    table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  }
  return table;
}();

// How many opcodes are one character: all of them up to 6 bits; above, the last symbols lead two.
unsigned single_opcodes(int bits) {
  const unsigned quantized = 1u << bits;
  return quantized <= 82 ? kSymbols : kSymbols - (quantized - 82 + 83) / 84;
}

// The mean of the last `window` steps. Sums run over blocks of `window` steps: forwards over the
// block that has begun, backwards over the one before. So none is longer than a window, and nothing
// accumulates.
class MovingMean {
 public:
  MovingMean(std::size_t window, std::size_t steps)
      : window_(std::max<std::size_t>(std::min(window, steps), 1)), sums_(window_ + 1) {}

  double value() const { return mean_; }

  void append(double step) {
    sums_[at_++] = step;
    forwards_ += step;
    if (count_ < window_) divisor_ = static_cast<double>(++count_);
    mean_ = (sums_[at_] + forwards_) / divisor_;
    if (at_ == window_) {
      for (std::size_t k = window_ - 1; k-- > 0;) sums_[k] += sums_[k + 1];
      at_ = 0;
      forwards_ = 0;
    }
  }

 private:
  std::size_t window_;
  std::size_t at_ = 0;
  std::size_t count_ = 0;
  double forwards_ = 0;
  double divisor_ = 1;
  double mean_ = 0;
  // Up to at_ the steps of this block; from there on the sums of the last steps of the block
  // before.
  std::vector<double> sums_;
};

// The prediction of the next value from those decoded: the last one, or, past the paper, the
// polynomial of degree `order` through the last order + 1, as soon as there are so many.
class Predictor {
 public:
  Predictor(int order, double first) : order_(order) {
    double binomial = 1;
    for (int k = 0; k <= order; ++k) {
      binomial = binomial * (order + 1 - k) / (k + 1);
      coefficients_[k] = k % 2 == 0 ? binomial : -binomial;
    }
    last_[0] = first;
  }

  // Whether enough values are there; what is predicted from fewer gives no step to the mean.
  bool complete() const { return known_ > order_; }

  double value() const {
    if (order_ == 0 || !complete()) return last_[0];
    double predicted = 0;
    for (int k = 0; k <= order_; ++k) predicted += coefficients_[k] * last_[k];
    return predicted;
  }

  void append(double value) {
    for (int k = order_; k > 0; --k) last_[k] = last_[k - 1];
    last_[0] = value;
    known_ += !complete();
  }

 private:
  int order_;
  int known_ = 1;
  std::array<double, kMostOrder + 1> coefficients_{};
  std::array<double, kMostOrder + 1> last_{};
};

double scale_of(const Parameters& parameters) { return parameters.bound / (1 << parameters.bits); }

class OpcodeWriter {
 public:
  OpcodeWriter(int bits, std::size_t steps) : single_(single_opcodes(bits)), text_(3 * steps, 0) {}

  // Writes nothing where not `wanted`; without a branch, since signs are hard to foresee.
  void write_neg(bool wanted) {
    text_[size_] = kAlphabet[kNeg];
    size_ += wanted;
  }

  void write(unsigned opcode) {
    if (opcode < single_) {
      text_[size_++] = kAlphabet[opcode];
    } else {
      text_[size_++] = kAlphabet[single_ + (opcode - single_) / kSymbols];
      text_[size_++] = kAlphabet[(opcode - single_) % kSymbols];
    }
  }

  std::string finish() {
    text_.resize(size_);
    return std::move(text_);
  }

 private:
  unsigned single_;
  std::size_t size_ = 0;
  std::string text_;
};

// Calls `each` with every opcode, up to the first fault.
template <class Each>
Scan read(std::string_view text, int bits, Each each) {
  Scan found;
  const unsigned single = single_opcodes(bits);
  const unsigned most = kApx + (1u << bits) - 1;
  const auto stop = [&found](Fault fault, std::size_t at) {
    found.fault = fault;
    found.fault_at = at;
    return found;
  };
  for (std::size_t at = 0; at < text.size(); ++at) {
    unsigned opcode = kSymbolOf[static_cast<unsigned char>(text[at])];
    if (opcode == kNoSymbol) return stop(Fault::alphabet, at);
    if (opcode >= single) {
      if (++at == text.size()) return stop(Fault::cut_off, at);
      const unsigned second = kSymbolOf[static_cast<unsigned char>(text[at])];
      if (second == kNoSymbol) return stop(Fault::alphabet, at);
      opcode = single + (opcode - single) * kSymbols + second;
    }
    if (opcode > most) return stop(Fault::opcode, at);
    found.steps += opcode != kNeg;
    found.raws += opcode == kRaw;
    each(opcode);
  }
  return found;
}

}  // namespace

Record encode(std::span<const double> values, const Parameters& parameters, const Limits& limits) {
  Record record;
  if (values.empty()) return record;
  record.table.push_back(values[0]);
  const double scale = scale_of(parameters);
  const double levels = 1 << parameters.bits;
  MovingMean mean(parameters.window, values.size());
  Predictor predictor(parameters.order, values[0]);
  OpcodeWriter writer(parameters.bits, values.size());
  bool was_negative = false;
  for (const double v : values.subspan(1)) {
    const double predicted = predictor.value();
    const double d = v - predicted;
    const bool negative = !(d >= 0);  // line 11
    unsigned opcode = kRaw;
    double decoded = v;
    if (d == 0) {  // line 15
      opcode = kEql;
      decoded = predicted;
    } else if (mean.value() > 0) {  // line 18
      const double unit = mean.value() * scale;
      const double quotient = std::abs(d) / unit + limits.round_offset;
      if (quotient < levels) {
        const auto q = static_cast<std::int32_t>(quotient);  // Eq. 2.2
        const double change = q * unit;
        const double near = predicted + (negative ? -change : change);
        const double error = std::abs(v - near);
        if (error < limits.tolerance && error <= limits.max_error) {  // line 21
          opcode = limits.spare_signs && q == 0 ? kEql : kApx + static_cast<unsigned>(q);
          decoded = near;
          record.squared_error += error * error;
        }
      }
    }
    const bool flip = negative != was_negative && (opcode >= kApx || !limits.spare_signs);
    writer.write_neg(flip);  // line 12
    was_negative ^= flip;
    if (opcode == kRaw) record.table.push_back(v);
    writer.write(opcode);
    if (predictor.complete()) mean.append(std::abs(decoded - predicted));
    predictor.append(decoded);
  }
  record.opcodes = writer.finish();
  return record;
}

Scan scan(std::string_view opcodes, int bits) {
  return read(opcodes, bits, [](unsigned) {});
}

void decode(std::string_view opcodes, std::span<const double> table, const Parameters& parameters,
            std::span<double> values) {
  const Scan asked = scan(opcodes, parameters.bits);
  if (asked.fault != Fault::none) fail("no string of opcodes");
  const std::size_t first = values.empty() ? 0 : 1;
  if (asked.steps + first != values.size()) fail("wrong number of opcodes");
  if (asked.raws + first != table.size()) {
    fail("look-up table too short or too long");
  }
  if (values.empty()) return;

  values[0] = table[0];
  const double scale = scale_of(parameters);
  MovingMean mean(parameters.window, values.size());
  Predictor predictor(parameters.order, values[0]);
  auto out = values.begin() + 1;
  auto next = table.begin() + 1;
  double sign = 1;
  read(opcodes, parameters.bits, [&](unsigned opcode) {
    if (opcode == kNeg) {
      sign = -sign;
      return;
    }
    const double predicted = predictor.value();
    double decoded = predicted;
    if (opcode == kRaw) {
      decoded = *next++;
    } else if (opcode != kEql) {
      const double change = (opcode - kApx) * (mean.value() * scale);
      decoded = predicted + sign * change;
    }
    *out++ = decoded;
    if (predictor.complete()) mean.append(std::abs(decoded - predicted));
    predictor.append(decoded);
  });
}

}  // namespace mocapress::diffma
