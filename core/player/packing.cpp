#include "player/packing.hpp"

#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "coding/fail.hpp"
#include "player/dictionary.hpp"

namespace mocapress::player {
namespace {

constexpr std::size_t kLeastWindow = 1 << 12, kMostWindow = 1 << 26;

// Both give whether exactly `data` comes out of all that is packed.

bool unpack_lzma2(ByteView packed, Bytes& data) {
  lzma_options_lzma options;
  if (lzma_lzma_preset(&options, LZMA_PRESET_DEFAULT)) fail("no LZMA");
  options.dict_size = static_cast<std::uint32_t>(
      std::clamp(std::bit_ceil(std::max<std::size_t>(data.size(), 1)), kLeastWindow, kMostWindow));
  const lzma_filter filters[] = {{LZMA_FILTER_LZMA2, &options}, {LZMA_VLI_UNKNOWN, nullptr}};
  std::size_t taken = 0, given = 0;
  const auto result = lzma_raw_buffer_decode(filters, nullptr, packed.data(), &taken, packed.size(),
                                             data.data(), &given, data.size());
  return result == LZMA_OK && taken == packed.size() && given == data.size();
}

bool inflate_raw(ByteView packed, Bytes& data) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  const ByteView known = dictionary();
  inflateSetDictionary(&stream, known.data(), static_cast<uInt>(known.size()));
  stream.next_in = const_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = data.data();
  stream.avail_out = static_cast<uInt>(data.size());
  const int result = inflate(&stream, Z_FINISH);
  const bool whole = result == Z_STREAM_END && stream.avail_in == 0 && stream.avail_out == 0;
  inflateEnd(&stream);
  return whole;
}

}  // namespace

Bytes unpack(Record record, std::size_t most) {
  const auto method = record.integer(2);
  const std::size_t size = record.integer(most);
  const ByteView packed = record.raw(record.left());
  if (method == 0) {
    if (packed.size() != size) fail("content of another size than announced");
    return {packed.begin(), packed.end()};
  }
  if (packed.size() > std::size_t{1} << 30) fail("packed content too large");
  Bytes data(size);
  if (!(method == 1 ? unpack_lzma2(packed, data) : inflate_raw(packed, data))) {
    fail("packed content is damaged");
  }
  return data;
}

}  // namespace mocapress::player
