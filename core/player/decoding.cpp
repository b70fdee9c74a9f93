#include "player/decoding.hpp"

#include <array>
#include <string_view>

#include "coding/fail.hpp"
#include "exact/header.hpp"
#include "near/codec.hpp"
#include "patterns/codec.hpp"
#include "patterns/plan.hpp"
#include "player/error.hpp"
#include "qssd/codec.hpp"

namespace mocapress::player {
namespace {

constexpr std::int64_t kMostChunk = 1 << 20;

struct Codec {
  std::string_view id;
  std::int64_t chunk;  // frames of a chunk at most, where the file does not say it
  void (*decode)(const Stream& stream, ByteView header, const Chunk& chunk, double* values);
};

// The value of a parameter, from 1 up to `most`.
std::int64_t parameter(const Stream& stream, const char* name, std::int64_t usual,
                       std::int64_t most) {
  const auto found = stream.parameters.find(name);
  const std::int64_t value = found == stream.parameters.end() ? usual : found->second;
  if (value < 1 || value > most) fail("a parameter of a codec out of its bounds");
  return value;
}

void decode_exact(const Stream& stream, ByteView own, const Chunk& chunk, double* values) {
  const std::size_t columns = stream.columns.size();
  const auto header = exact::read_header(own, columns);
  if (header.has_model) fail("the clip was coded with a model");
  const auto level = static_cast<int>(parameter(stream, "level", exact::kUsualLevel, 9));
  exact::decode(chunk.payload, values, chunk.frames, chunk.frames, columns, header, level,
                exact::Start{});
}

void decode_near(const Stream& stream, ByteView own, const Chunk& chunk, double* values) {
  const auto plan = near::read_header(own, stream.columns.size());
  near::decode(chunk.payload, values, chunk.frames, plan);
}

void decode_patterns(const Stream& stream, ByteView own, const Chunk& chunk, double* values) {
  const auto plan = patterns::read_plan(own, {}, stream.columns.size());
  patterns::decode(chunk.payload, values, chunk.frames, plan);
}

void decode_qssd(const Stream& stream, ByteView own, const Chunk& chunk, double* values) {
  const auto plan = qssd::read_plan(own, {}, stream.columns.size());
  qssd::decode(chunk.payload, values, chunk.frames, plan);
}

constexpr std::array<Codec, 4> kCodecs = {{{"exact", 512, decode_exact},
                                           {"near", 1024, decode_near},
                                           {"patterns", 2048, decode_patterns},
                                           {"qssd", 2048, decode_qssd}}};

const Codec* codec_of(const Stream& stream) {
  for (const auto& codec : kCodecs) {
    if (codec.id == stream.codec) return &codec;
  }
  return nullptr;
}

}  // namespace

void check_codec(const Stream& stream) {
  if (codec_of(stream) == nullptr) {
    throw Unsupported("coded by " + stream.codec.substr(0, 40) +
                      ", not by exact, near, patterns or qssd");
  }
  if (stream.has_model) throw Unsupported("coded with a model");
}

void decode(const Stream& stream, const Chunk& chunk, double* values) {
  const Codec* codec = codec_of(stream);
  if (codec == nullptr) fail("coded by another codec");
  const auto most = parameter(stream, "chunk", codec->chunk, kMostChunk);
  if (chunk.frames > static_cast<std::uint64_t>(most)) fail("a chunk of too many frames");
  codec->decode(stream, chunk.own_header ? chunk.header : ByteView(stream.header), chunk, values);
  const std::size_t size = chunk.frames * stream.columns.size() * sizeof(double);
  if (!fits(chunk.digest, values, size)) fail("a chunk decodes to other values than were coded");
}

}  // namespace mocapress::player
