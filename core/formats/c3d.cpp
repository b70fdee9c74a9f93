#include "formats/c3d.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace mocapress {
namespace {

constexpr std::uint64_t kBlock = 512;
constexpr std::uint64_t kInPoint = 4;
constexpr std::uint64_t kInRotation = 17;
constexpr std::uint64_t kCounts = 1 << 16;
constexpr std::size_t kMostParameters = 1 << 14;

// Reads numbers as the file's processor wrote them; 0 beyond the end.
class Bytes16 {
 public:
  Bytes16(ByteView data, C3dProcessor processor) : data_(data), processor_(processor) {}

  std::uint64_t integer(std::uint64_t at) const {
    if (at + 2 > data_.size()) return 0;
    const unsigned low = data_[at];
    const unsigned high = data_[at + 1];
    return processor_ == C3dProcessor::mips ? low << 8 | high : high << 8 | low;
  }

  double real(std::uint64_t at) const {
    const std::uint64_t first = integer(at);
    const std::uint64_t second = integer(at + 2);
    // The halves of a DEC float are swapped, its exponent is two higher.
    const bool low_first = processor_ == C3dProcessor::intel;
    const auto bits =
        static_cast<std::uint32_t>(low_first ? second << 16 | first : first << 16 | second);
    const double number = std::bit_cast<float>(bits);
    return processor_ == C3dProcessor::dec ? number / 4 : number;
  }

  ByteView data() const { return data_; }

 private:
  ByteView data_;
  C3dProcessor processor_;
};

C3dProcessor processor_of(ByteView data, std::uint64_t section) {
  const std::uint64_t at = section + 3;
  if (at < data.size() && data[at] == static_cast<std::uint8_t>(C3dProcessor::dec)) {
    return C3dProcessor::dec;
  }
  if (at < data.size() && data[at] == static_cast<std::uint8_t>(C3dProcessor::mips)) {
    return C3dProcessor::mips;
  }
  return C3dProcessor::intel;
}

int signed_byte(std::uint8_t byte) { return byte < 128 ? byte : byte - 256; }

std::string_view text(ByteView data, std::uint64_t at, std::uint64_t size) {
  return {reinterpret_cast<const char*>(data.data()) + at, static_cast<std::size_t>(size)};
}

// The data of a parameter whose type stands at an offset; false where it goes beyond the end.
bool read_parameter(ByteView data, std::uint64_t at, C3dParameter& parameter) {
  if (at + 2 > data.size()) return false;
  parameter.type = signed_byte(data[at]);
  const std::uint64_t dimensions = data[at + 1];
  if (dimensions > 7 || at + 2 + dimensions > data.size()) return false;
  parameter.dimensions = data.subspan(at + 2, dimensions);
  parameter.begin = at + 2 + dimensions;
  parameter.size = static_cast<std::uint64_t>(std::abs(parameter.type));
  for (const std::uint8_t dimension : parameter.dimensions) parameter.size *= dimension;
  return parameter.size <= data.size() - parameter.begin;
}

std::vector<C3dParameter> read_parameters(const Bytes16& bytes, std::uint64_t section) {
  const ByteView data = bytes.data();
  std::vector<C3dParameter> found;
  for (std::uint64_t at = section + 4; at + 2 <= data.size() && found.size() < kMostParameters;) {
    const int length = std::abs(signed_byte(data[at]));
    const int id = signed_byte(data[at + 1]);
    const std::uint64_t name = at + 2;
    const std::uint64_t link = name + static_cast<std::uint64_t>(length);
    if (length == 0 || id == 0 || link + 2 > data.size()) break;
    C3dParameter parameter;
    parameter.group = std::abs(id);
    parameter.is_group = id < 0;
    parameter.name = text(data, name, static_cast<std::uint64_t>(length));
    if (parameter.is_group || read_parameter(data, link + 2, parameter)) found.push_back(parameter);
    const std::uint64_t distance = bytes.integer(link);
    if (distance < 2) break;  // the last one, or one that leads nowhere
    at = link + distance;
  }
  return found;
}

bool same_name(std::string_view one, std::string_view other) {
  return std::ranges::equal(one, other, [](char a, char b) {
    const auto upper = [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; };
    return upper(a) == b;
  });
}

// Whole numbers of a parameter, whatever its type, of its group.
class Parameters {
 public:
  Parameters(const Bytes16& bytes, const std::vector<C3dParameter>& all)
      : bytes_(bytes), all_(all) {}

  std::optional<std::uint64_t> whole(std::string_view group, std::string_view name) const {
    const C3dParameter* found = find(group, name);
    if (found == nullptr) return std::nullopt;
    if (found->type == 2 && found->size >= 4 && name.ends_with("FIELD")) {
      return bytes_.integer(found->begin) | bytes_.integer(found->begin + 2) << 16;
    }
    if (found->type == 2 && found->size >= 2) return bytes_.integer(found->begin);
    if (found->type == 1 && found->size >= 1) return bytes_.data()[found->begin];
    if (found->type == 4 && found->size >= 4) {
      const double number = bytes_.real(found->begin);
      if (number >= 0 && number < 4e9) return static_cast<std::uint64_t>(number);
    }
    return std::nullopt;
  }

 private:
  const C3dParameter* find(std::string_view group, std::string_view name) const {
    for (const auto& own : all_) {
      if (!own.is_group || !same_name(own.name, group)) continue;
      for (const auto& parameter : all_) {
        if (!parameter.is_group && parameter.group == own.group &&
            same_name(parameter.name, name)) {
          return &parameter;
        }
      }
    }
    return nullptr;
  }

  const Bytes16& bytes_;
  const std::vector<C3dParameter>& all_;
};

void add(std::vector<std::uint64_t>& list, std::optional<std::uint64_t> value) {
  if (value && std::ranges::find(list, *value) == list.end()) list.push_back(*value);
}

// How much neighbouring records differ, in numbers of a beginning of the frames: of several ways to
// lay them out, the right one is the smoothest.
double roughness(const Bytes16& bytes, bool floats, const C3dFrames& frames) {
  constexpr std::uint64_t kSample = 4096;
  const std::uint64_t size = floats ? 4 : 2;
  const std::uint64_t all = frames.numbers * frames.count;
  double moved = 0;
  double seen = 0;
  for (std::uint64_t i = 0; i + frames.numbers < std::min(all, kSample + frames.numbers); ++i) {
    const auto number = [&](std::uint64_t index) {
      const std::uint64_t at = frames.begin + index * size;
      const double found = floats ? bytes.real(at) : static_cast<std::int16_t>(bytes.integer(at));
      return std::fabs(found) < 1e9 ? found : 0;
    };
    const double before = number(i);
    moved += std::fabs(number(i + frames.numbers) - before);
    seen += std::fabs(before);
  }
  return seen > 0 ? moved / seen : 0;
}

struct Candidate {
  std::uint64_t points, analog, samples, announced;
  C3dFrames frames;
  int rank;  // 0 fills the file up to a block, 1 leaves more
  std::uint64_t rest;
};

}  // namespace

C3dLayout c3d_layout(ByteView data, std::uint64_t file_size) {
  C3dLayout layout;
  if (data.size() < kBlock) return layout;
  const std::uint64_t section = data[0] > 0 ? (data[0] - 1) * kBlock : 0;
  layout.processor = processor_of(data, section);
  const Bytes16 bytes(data, layout.processor);
  layout.parameters = read_parameters(bytes, section);
  const Parameters parameters(bytes, layout.parameters);
  layout.floats = bytes.real(12) < 0;
  const std::uint64_t size = layout.floats ? 4 : 2;

  std::vector<std::uint64_t> starts;
  add(starts, bytes.integer(16));
  add(starts, parameters.whole("POINT", "DATA_START"));
  std::vector<std::uint64_t> points;
  add(points, bytes.integer(2));
  add(points, parameters.whole("POINT", "USED"));
  const std::uint64_t samples = std::max<std::uint64_t>(bytes.integer(18), 1);
  std::vector<std::uint64_t> analogs;
  add(analogs, bytes.integer(4));
  add(analogs, bytes.integer(4) * samples);
  if (const auto used = parameters.whole("ANALOG", "USED")) add(analogs, *used * samples);
  std::vector<std::uint64_t> counts;
  const std::uint64_t range = (bytes.integer(8) - bytes.integer(6) + 1) & 0xffff;
  add(counts, range);
  const auto first = parameters.whole("TRIAL", "ACTUAL_START_FIELD");
  const auto last = parameters.whole("TRIAL", "ACTUAL_END_FIELD");
  if (first && last && *last >= *first) add(counts, *last - *first + 1);
  add(counts, parameters.whole("POINT", "LONG_FRAMES"));
  add(counts, parameters.whole("POINT", "FRAMES"));

  const std::uint64_t rotations = parameters.whole("ROTATION", "USED").value_or(0);
  const std::uint64_t rotation_start = parameters.whole("ROTATION", "DATA_START").value_or(0);
  const std::uint64_t rotation_begin = rotation_start > 0 ? (rotation_start - 1) * kBlock : 0;

  std::optional<Candidate> best;
  const auto better = [&](const Candidate& one) {
    if (!best || one.rank != best->rank) return !best || one.rank < best->rank;
    if (one.rank == 1) return one.rest < best->rest;
    return one.frames.numbers != best->frames.numbers &&
           roughness(bytes, layout.floats, one.frames) <
               0.5 * roughness(bytes, layout.floats, best->frames);
  };
  for (const std::uint64_t start : starts) {
    if (start < 2 || (start - 1) * kBlock >= file_size) continue;
    const std::uint64_t begin = (start - 1) * kBlock;
    const bool before_rotations = rotations > 0 && rotation_begin > begin;
    const std::uint64_t end = before_rotations ? std::min(rotation_begin, file_size) : file_size;
    for (const std::uint64_t of_points : points) {
      for (const std::uint64_t analog : analogs) {
        const std::uint64_t numbers = kInPoint * of_points + analog;
        if (numbers == 0) continue;
        const std::uint64_t most = (end - begin) / (numbers * size);
        std::vector<std::uint64_t> tried = counts;
        add(tried, most);
        // The header's count of 16 bits has overflowed in a long file, or stands at its end.
        const std::uint64_t wrapped = most > range ? most - (most - range) % kCounts : range;
        const bool long_file = most == wrapped || (range == kCounts - 1 && most > range);
        add(tried, wrapped);
        for (const std::uint64_t count : tried) {
          if (count == 0 || count > most) continue;
          const std::uint64_t rest = end - begin - count * numbers * size;
          const bool divides = analog % samples == 0;
          const bool announced =
              count != most || long_file || std::ranges::find(counts, most) != counts.end();
          const Candidate one{of_points,
                              analog,
                              divides ? samples : 1,
                              range,
                              {begin, count, numbers},
                              rest <= kBlock && announced ? 0 : 1,
                              rest};
          if (better(one)) best = one;
        }
      }
    }
  }
  layout.announced = range;
  if (best) {
    layout.points = best->points;
    layout.analog = best->analog;
    layout.samples = best->samples;
    layout.frames = best->frames;
    layout.stated = std::ranges::find(counts, best->frames.count) != counts.end();
  }
  const std::uint64_t per_frame =
      std::max<std::uint64_t>(parameters.whole("ROTATION", "RATIO").value_or(1), 1);
  const std::uint64_t count = (best ? layout.frames.count : range) * per_frame;
  const std::uint64_t after =
      best ? layout.frames.begin + layout.frames.count * layout.frames.numbers * size : kBlock;
  if (rotations > 0 && layout.floats && count > 0 && rotation_begin >= after &&
      rotation_begin < file_size &&
      count <= (file_size - rotation_begin) / (rotations * kInRotation * 4)) {
    layout.rotations = {rotation_begin, count, rotations * kInRotation};
  }
  return layout;
}

}  // namespace mocapress
