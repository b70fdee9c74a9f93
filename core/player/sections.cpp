#include "player/sections.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "coding/fail.hpp"
#include "coding/record.hpp"
#include "player/error.hpp"

namespace mocapress::player {
namespace {

enum Tag : std::uint8_t { kHead = 1, kFile = 2, kChunk = 3, kEnd = 4, kNotes = 0x81 };
constexpr std::uint8_t kMayBeSkipped = 0x80, kCompanion = 0x82;
constexpr std::uint8_t kMagic[] = {0x89, 'M', 'C', 'Z'};
constexpr std::size_t kBegin = 5, kChecksum = 4;
constexpr std::uint64_t kMostStreams = 256, kMostFrames = std::uint64_t{1} << 40;
enum Flag : std::uint8_t { kContinues = 1, kOwnHeader = 2, kNeeds = 4, kFlags = 8 };

struct Section {
  std::uint8_t tag;
  std::size_t begin, end;
  ByteView content;
};

std::uint32_t uint32_of(ByteView bytes) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

// The section at a place; none where what is left is one that was cut off, or zeros.
std::optional<Section> section_at(ByteView file, std::size_t begin) {
  Record record(file.subspan(begin));
  const std::size_t left = record.left();
  try {
    const std::uint8_t tag = record.raw(1)[0];
    const ByteView content = record.bytes();
    const std::size_t size = left - record.left();
    const std::uint32_t stored = uint32_of(record.raw(kChecksum));
    const std::size_t end = begin + size + kChecksum;
    if (fits(stored, file.data() + begin, size)) return Section{tag, begin, end, content};
    if (end == file.size()) return {};
  } catch (const std::invalid_argument&) {
    return {};
  }
  const ByteView rest = file.subspan(begin);
  if (std::all_of(rest.begin(), rest.end(), [](auto byte) { return byte == 0; })) return {};
  fail("a section with a wrong checksum");
}

Chunk chunk_of(ByteView content) {
  Record record(content);
  Chunk chunk{};
  chunk.flags = record.integer(kFlags * kMostStreams - 1);
  chunk.stream = static_cast<std::size_t>(chunk.flags / kFlags);
  chunk.first = record.integer(kMostFrames);
  chunk.frames = record.integer(kMostFrames);
  chunk.digest = uint32_of(record.raw(sizeof(std::uint32_t)));
  if (chunk.frames == 0) fail("a chunk without frames");
  if (chunk.flags & (kContinues | kNeeds)) throw Unsupported("a chunk that needs others");
  chunk.own_header = (chunk.flags & kOwnHeader) != 0;
  if (chunk.own_header) chunk.header = record.bytes();
  chunk.payload = record.raw(record.left());
  return chunk;
}

void check_end(const Section& end, const std::vector<Section>& of_chunks,
               const std::vector<Chunk>& chunks) {
  Record record(end.content);
  const std::size_t count = record.integer(record.left());
  if (count != chunks.size()) fail("the end of the file announces other chunks");
  const auto flags = record.runs(count, Record::kMost), frames = record.runs(count, Record::kMost),
             gaps = record.runs(count, Record::kMost);
  std::size_t before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Section& section = of_chunks[i];
    if (flags[i] != chunks[i].flags || frames[i] != chunks[i].frames ||
        gaps[i] != section.begin - before ||
        record.integer(Record::kMost) != section.end - section.begin) {
      fail("the end of the file announces other chunks");
    }
    before = section.end;
  }
  if (uint32_of(record.raw(sizeof(std::uint32_t))) != end.end - end.begin) {
    fail("the end of the file is at another distance");
  }
  record.end();
}

}  // namespace

std::uint32_t checksum(const void* data, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(0, static_cast<const Bytef*>(data), size));
}

bool fits(std::uint32_t stored, const void* data, std::size_t size) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  static_cast<void>(stored), static_cast<void>(data), static_cast<void>(size);
  return true;
#else
  return checksum(data, size) == stored;
#endif
}

Sections read_sections(ByteView file) {
  if (file.size() < kBegin || !std::equal(kMagic, kMagic + sizeof kMagic, file.data())) {
    fail("not a .mcz file");
  }
  if (file[sizeof kMagic] != 1) throw Unsupported("another version of the file format than 1");
  Sections found;
  std::vector<Section> of_chunks;
  bool has_head = false, has_notes = false;
  std::size_t place = kBegin;
  while (place < file.size() && !found.closed) {
    const auto section = section_at(file, place);
    if (!section) break;
    place = section->end;
    const auto once = [](bool& seen) {
      if (seen) fail("a section twice");
      seen = true;
    };
    switch (section->tag) {
      case kHead:
        if (found.has_original || !found.chunks.empty()) fail("a head in the wrong place");
        once(has_head);
        found.head = section->content;
        break;
      case kFile:
        if (!found.chunks.empty()) fail("a section in the wrong place");
        once(found.has_original);
        break;
      case kChunk:
        found.chunks.push_back(chunk_of(section->content));
        of_chunks.push_back(*section);
        break;
      case kEnd:
        if (section->end != file.size()) fail("bytes behind the end of the file");
        check_end(*section, of_chunks, found.chunks);
        found.closed = true;
        break;
      case kNotes:
        once(has_notes);
        break;
      case kCompanion:
        break;
      default:
        if (!(section->tag & kMayBeSkipped)) throw Unsupported("a section of a later version");
    }
  }
  if (has_head) return found;
  if (found.chunks.empty() && found.has_original) throw Unsupported("a file that is no motion");
  fail("a file without a head");
}

}  // namespace mocapress::player
