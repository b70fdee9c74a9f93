#include "player/head.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "coding/fail.hpp"
#include "coding/record.hpp"

namespace mocapress::player {
namespace {

// docs/format.md, "Limits".
constexpr std::uint64_t kMostStreams = 256, kMostParameters = 64, kMostJoints = 1 << 16,
                        kMostColumns = 1 << 18, kMostEnds = 1 << 17, kMostFacts = 1 << 12,
                        kMostKinds = 64;
constexpr std::size_t kModelName = 32;
constexpr int kMostBits = 448, kMostExponent = 512;

std::string text(Record& record) {
  const ByteView bytes = record.bytes();
  return {bytes.begin(), bytes.end()};
}

// What the kind of a column says. Texts themselves may be long, and stand for many columns.
struct Meaning {
  std::optional<Kind> kind;  // none: a word of its own
  bool turns;                // whether it begins as rotations do
};

Meaning meaning(Record& record) {
  const std::string word = text(record);
  const bool turns = word.starts_with('r');
  for (std::size_t i = 0; i < kKindNames.size(); ++i) {
    if (kKindNames[i] == word) return {static_cast<Kind>(i), turns};
  }
  return {std::nullopt, turns};
}

std::vector<Meaning> meanings(Record& record, std::size_t count) {
  if (count > record.left()) fail("more kinds announced than a record holds");
  std::vector<Meaning> values;
  values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) values.push_back(meaning(record));
  return values;
}

// Of so many columns, whether their units are radians: texts, in which equal neighbours stand
// together.
std::vector<bool> in_radians(Record& record, std::size_t count) {
  std::vector<bool> values;
  while (values.size() < count) {
    const bool radians = text(record) == "rad";
    const std::size_t length = record.integer(count - values.size());
    if (length == 0) fail("an empty run");
    values.insert(values.end(), length, radians);
  }
  return values;
}

Vector vector_at(const std::vector<double>& numbers, std::size_t index) {
  return {numbers[3 * index], numbers[3 * index + 1], numbers[3 * index + 2]};
}

std::string axis_order(Record& record) {
  std::string order;
  for (const auto code : record.bytes()) order += code < 3 ? "xyz"[code] : '?';
  std::string sorted = order;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != "xyz") fail("no order of axes");
  return order;
}

Skeleton read_skeleton(Record& record) {
  Skeleton skeleton;
  const std::size_t count = record.integer(kMostJoints);
  if (count == 0) return skeleton;
  if (count > record.left()) fail("more joints announced than a record holds");
  const auto flags = record.integer(31);
  skeleton.fixed = (flags & 1) != 0;
  skeleton.radians = (flags & 2) != 0;
  skeleton.name = text(record);
  for (auto facts = record.integer(kMostFacts); facts > 0; --facts) {
    text(record);
    text(record);
  }
  if (flags & 4) skeleton.length_unit = record.number();
  auto& joints = skeleton.joints;
  joints.resize(count);
  for (auto& joint : joints) joint.name = text(record);
  for (std::size_t j = 0; j < count; ++j) {
    joints[j].parent =
        static_cast<std::int32_t>(j) - 1 - static_cast<std::int32_t>(record.integer(j));
  }
  std::size_t channels = 0, ends = 0;
  for (auto& joint : joints) {
    for (const auto code : record.bytes()) {
      if (code >= kKindNames.size()) fail("a channel of no kind");
      joint.channels.push_back(static_cast<Kind>(code));
    }
    channels += joint.channels.size();
  }
  if (channels > kMostColumns) fail("too many channels");
  for (auto& joint : joints) {
    joint.ends.resize(record.integer(kMostEnds - ends));
    ends += joint.ends.size();
  }
  const auto offsets = record.numbers(3 * (count + ends));
  std::size_t next = 0;
  for (auto& joint : joints) {
    joint.offset = vector_at(offsets, next++);
    for (auto& end : joint.ends) end = vector_at(offsets, next++);
  }
  if (flags & 8) {
    for (auto& joint : joints) joint.axis_order = axis_order(record);
    const auto axes = record.numbers(3 * count);
    for (std::size_t j = 0; j < count; ++j) joints[j].axis = vector_at(axes, j);
  }
  if (flags & 16) {
    std::size_t limited = 0;
    for (const auto& joint : joints) limited += record.integer(joint.channels.size());
    record.numbers(2 * limited);
  }
  return skeleton;
}

// An integer of many bits, as the double nearest to it, but for rounding in steps.
double wide(Record& record) {
  double value = 0, scale = 1;
  for (int bits = 0; bits <= kMostBits; bits += 7, scale *= 128) {
    const std::uint8_t byte = record.raw(1)[0];
    value += scale * (byte & 0x7F);
    if (byte < 0x80) return value;
  }
  fail("an integer too long");
}

double read_time(Record& record) {
  const auto form = record.integer(2);
  if (form == 0) return 0;
  const double first = wide(record);
  double time = 0;
  if (form == 1) {
    const auto exponent = record.signed_integer();
    if (exponent < -kMostExponent || exponent > kMostExponent) fail("no frame time");
    const double power = std::pow(10.0, static_cast<double>(std::abs(exponent)));
    time = exponent < 0 ? first / power : first * power;
  } else {
    time = first / wide(record);
  }
  // Nobody's frames are so short or long that a double does not hold them.
  return std::isfinite(time) && time > 0 ? time : 0;
}

struct Columns {
  std::vector<Meaning> kinds;
  std::vector<bool> radians;
  std::vector<std::int32_t> joints;
};

Columns read_columns(Record& record, const Skeleton& skeleton) {
  const std::size_t count = record.integer(kMostColumns);
  const auto form = record.integer(3);
  const auto most_joints = skeleton.joints.empty() ? kMostJoints : skeleton.joints.size();
  Columns columns;
  if (form == 0) {
    for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
      for (const Kind kind : skeleton.joints[j].channels) {
        columns.kinds.push_back({kind, is_rotation(kind)});
        columns.radians.push_back(skeleton.radians);
        columns.joints.push_back(static_cast<std::int32_t>(j));
      }
    }
    if (columns.kinds.size() != count) fail("other columns than the skeleton has channels");
    return columns;
  }
  if (form == 3) {
    const auto kinds = meanings(record, record.integer(kMostKinds));
    if (kinds.empty() || count % kinds.size() != 0) fail("columns in groups of another size");
    for (std::size_t c = 0; c < count; ++c) columns.kinds.push_back(kinds[c % kinds.size()]);
    columns.radians.resize(count);
    columns.joints.assign(count, -1);
    return columns;
  }
  if (form == 1) {
    std::size_t left = count;
    std::int64_t expected = 0;
    for (auto bones = record.integer(count); bones > 0; --bones) {
      text(record);
      const std::size_t own = record.integer(left);
      if (own == 0) fail("a bone without columns");
      const std::int64_t apart = record.signed_integer();
      if (apart < -(std::int64_t{1} << 20) || apart > std::int64_t{1} << 20) fail("no joint");
      const std::int64_t joint = expected + apart;
      if (joint < -1 || joint >= static_cast<std::int64_t>(most_joints))
        fail("a column of no joint");
      expected = joint + 1;
      left -= own;
      columns.joints.insert(columns.joints.end(), own, static_cast<std::int32_t>(joint));
    }
    if (left > 0) fail("columns of no bone");
  } else {
    meanings(record, count);  // their names
    for (const auto joint : record.runs(count, most_joints)) {
      columns.joints.push_back(static_cast<std::int32_t>(joint) - 1);
    }
  }
  columns.kinds = meanings(record, count);
  columns.radians = in_radians(record, count);
  return columns;
}

void read_parameter(Record& record, Stream& stream) {
  const std::string name = text(record);
  switch (record.raw(1)[0]) {
    case 0:
      stream.parameters[name] = record.signed_integer();
      break;
    case 1:
      record.number();
      break;
    case 2:
      text(record);
      break;
    case 3:
      record.integer(1);
      break;
    default:
      fail("a parameter of no type");
  }
}

void read_channels(Record record, const Skeleton& skeleton, Stream& stream) {
  const auto frames = record.integer();
  if (frames > 0) stream.frames = frames - 1;
  stream.frame_time = read_time(record);
  const Columns columns = read_columns(record, skeleton);
  bool turned = false;
  for (std::size_t c = 0; c < columns.kinds.size(); ++c) {
    const auto [kind, turns] = columns.kinds[c];
    stream.columns.push_back(kind ? ChannelPlace{columns.joints[c], *kind} : ChannelPlace{});
    if (turns && !turned) stream.radians = columns.radians[c];
    turned |= turns;
  }
  const std::size_t formats = record.integer(record.left() / 4);
  record.raw(4 * formats);
  record.runs(stream.columns.size(), formats);
  stream.codec = text(record);
  for (auto left = record.integer(kMostParameters); left > 0; --left)
    read_parameter(record, stream);
  const std::size_t model = record.bytes().size();
  if (model != 0 && model != kModelName) fail("no name of a model");
  stream.has_model = model != 0;
  const ByteView header = record.bytes();
  stream.header.assign(header.begin(), header.end());
  record.end();
}

}  // namespace

Head read_head(ByteView unpacked) {
  Record record(unpacked);
  Head head;
  head.skeleton = read_skeleton(record);
  head.streams.resize(record.integer(kMostStreams));
  std::set<std::string_view> names;
  std::size_t columns = 0;
  for (auto& stream : head.streams) {
    stream.name = text(record);
    stream.kind = text(record);
    const Record own(record.bytes());
    if (stream.kind == "channels") read_channels(own, head.skeleton, stream);
    columns += stream.columns.size();
    if (!names.insert(stream.name).second) fail("two streams of one name");
  }
  record.end();
  if (head.streams.empty()) fail("a head without streams");
  if (columns > kMostColumns) fail("too many columns");
  return head;
}

}  // namespace mocapress::player
