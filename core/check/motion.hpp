// Made-up motion and digests, the same in every build: only whole numbers are computed with, and
// each value is one division, which IEEE 754 rounds alike everywhere.
#pragma once

#include <bit>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace mocapress::check {

static_assert(FLT_EVAL_METHOD == 0, "doubles are computed with as doubles");
static_assert(std::numeric_limits<double>::is_iec559);

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}

  std::uint64_t next() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return state_ * 0x2545F4914F6CDD1Du;
  }

  // From -bound to bound.
  std::int64_t around(std::int64_t bound) {
    return static_cast<std::int64_t>(next() >> 1) % (2 * bound + 1) - bound;
  }

 private:
  std::uint64_t state_;
};

// frames x channels values with four decimals: every channel's speed wanders and is pulled back
// towards zero, every third channel follows the two before it, every seventh stands still.
inline std::vector<double> motion(std::size_t frames, std::size_t channels, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> values(frames * channels);
  std::vector<std::int64_t> place(channels), speed(channels);
  for (auto& p : place) p = random.around(900000);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t c = 0; c < channels; ++c) {
      if (c % 7 != 6) {
        speed[c] += random.around(200) - place[c] / 4096 - speed[c] / 64;
        place[c] += speed[c];
      }
      std::int64_t value = place[c];
      if (c % 3 == 2) value = place[c - 1] / 2 - place[c - 2] / 3 + place[c] % 64;
      values[f * channels + c] = static_cast<double>(value) / 10000.0;
    }
  }
  return values;
}

// Any bits: NaN, infinities, denormals, huge numbers; every fourth value close to the one before.
inline std::vector<double> noise(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> values(count);
  std::uint64_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    last = i % 4 == 3 ? last + random.next() % 1000 : random.next();
    values[i] = std::bit_cast<double>(last);
  }
  return values;
}

// FNV-1a, 64 bits.
inline std::uint64_t digest(const void* data, std::size_t size) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (std::size_t i = 0; i < size; ++i) {
    hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 0x100000001B3u;
  }
  return hash;
}

// Prints what numbers came out on the way.
inline void report(const std::string& what, std::span<const double> numbers) {
  std::printf("%s: %016llx\n", what.c_str(),
              static_cast<unsigned long long>(digest(numbers.data(), numbers.size_bytes())));
}

// Prints what a payload is and whether it gave the values back; returns the latter.
inline bool report(const std::string& what, std::span<const std::uint8_t> payload,
                   std::span<const double> values, std::span<const double> decoded) {
  const bool same = values.size() == decoded.size() &&
                    std::memcmp(values.data(), decoded.data(), values.size_bytes()) == 0;
  std::printf("%s: %zu bytes, %016llx, %s\n", what.c_str(), payload.size(),
              static_cast<unsigned long long>(digest(payload.data(), payload.size())),
              same ? "restored" : "NOT RESTORED");
  return same;
}

}  // namespace mocapress::check
