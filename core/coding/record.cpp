#include "coding/record.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "coding/fail.hpp"

namespace mocapress {

static_assert(std::endian::native == std::endian::little);

ByteView Record::raw(std::size_t count) {
  if (count > left_.size()) fail("a record is cut off");
  const ByteView taken = left_.first(count);
  left_ = left_.subspan(count);
  return taken;
}

std::uint64_t Record::integer(std::uint64_t most) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const std::uint64_t byte = raw(1)[0];
    if (shift == 63 && byte > 1) break;
    value |= (byte & 0x7F) << shift;
    if (byte < 0x80) {
      if (value > most) fail("a number too large for its place in a record");
      return value;
    }
  }
  fail("an integer too long");
}

std::int64_t Record::signed_integer() {
  const std::uint64_t value = integer(~std::uint64_t{0});
  const auto half = static_cast<std::int64_t>(value >> 1);
  return value % 2 == 0 ? half : -half - 1;
}

double Record::number() {
  double value;
  std::memcpy(&value, raw(sizeof value).data(), sizeof value);
  return value;
}

std::vector<double> Record::numbers(std::size_t count) {
  constexpr double kScales[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const double scale = kScales[integer(15)];
  if (count > left_.size()) fail("more numbers announced than a record holds");
  std::vector<double> values(count);
  for (double& value : values) {
    const std::uint64_t k = integer(std::uint64_t{1} << 54);
    if (k == 0) {
      value = number();
    } else {
      const double magnitude = static_cast<double>((k - 1) >> 1) / scale;
      value = k % 2 == 0 ? -magnitude : magnitude;
    }
  }
  return values;
}

std::vector<std::uint64_t> Record::runs(std::size_t count, std::uint64_t most) {
  std::vector<std::uint64_t> values;
  while (values.size() < count) {
    const std::uint64_t value = integer(most);
    const std::size_t length = integer(count - values.size());
    if (length == 0) fail("an empty run");
    values.insert(values.end(), length, value);
  }
  return values;
}

std::vector<std::uint64_t> Record::palette(std::size_t count, std::uint64_t most) {
  std::vector<std::uint64_t> different(integer(std::min(count, left_.size())));
  for (auto& value : different) value = integer(most);
  std::vector<std::uint64_t> values;
  values.reserve(count);
  for (const auto index : indices(count, different.size())) values.push_back(different[index]);
  return values;
}

std::vector<std::size_t> Record::indices(std::size_t count, std::size_t size) {
  if (size == 0 && count > 0) fail("an empty palette");
  if (size < 2) return std::vector<std::size_t>(count);
  std::vector<std::size_t> made;
  while (made.size() < count) {
    const std::uint64_t run = integer(std::uint64_t{size} * count - 1);
    const std::size_t length = run / size, left = count - made.size();
    if (length >= left) fail("a run longer than its list");
    made.insert(made.end(), length > 0 ? length : left, run % size);
  }
  return made;
}

void Record::end() const {
  if (!left_.empty()) fail("bytes are left over behind a record");
}

}  // namespace mocapress
