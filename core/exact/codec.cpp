#include "exact/codec.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "coding/fail.hpp"
#include "coding/sides.hpp"
#include "exact/model.hpp"
#include "exact_fast/codec.hpp"

namespace mocapress::exact {
namespace {

constexpr double kJump = 12;             // moves; further than that is a jump
constexpr std::size_t kSoundEvery = 16;  // frames

// Whether most columns that move jump into row `f` many times as far as they move before and after.
bool is_cut(const double* values, std::size_t frames, std::size_t columns, std::size_t f) {
  if (f == 0 || f + 1 == frames) return false;
  const auto move = [&](std::size_t frame, std::size_t c) {
    return std::fabs(values[frame * columns + c] - values[(frame - 1) * columns + c]);
  };
  std::size_t moving = 0;
  std::size_t jumping = 0;
  for (std::size_t c = 0; c < columns; ++c) {
    const double jump = move(f, c);
    if (!(jump > 0)) continue;
    ++moving;
    if (jump > kJump * (move(f + 1, c) + (f > 1 ? move(f - 1, c) : 0))) ++jumping;
  }
  return 2 * jumping > moving;
}

// A part of a clip's columns that is coded on its own, so that memory does not grow with the number
// of columns; clips of motion are one part.
struct Part {
  Part(const Clip& clip, std::size_t from, std::size_t to) : from(from), count(to - from) {
    for (const Coupling& coupling : clip.couplings) {
      const auto inside = [&](std::uint16_t column) { return column >= from && column < to; };
      if (!std::ranges::all_of(coupling.sources, inside) ||
          !std::ranges::all_of(coupling.targets, inside)) {
        continue;
      }
      Coupling own = coupling;
      for (auto& column : own.sources) column = static_cast<std::uint16_t>(column - from);
      for (auto& column : own.targets) column = static_cast<std::uint16_t>(column - from);
      couplings.push_back(std::move(own));
    }
    start.shared = clip.start.shared;
    for (std::size_t c = from; c < std::min(to, clip.start.columns.size()); ++c) {
      start.columns.push_back(clip.start.columns[c]);
    }
    columns = clip.columns.subspan(from, count);
    level = clip.level;
  }

  Clip clip() const { return {columns, couplings, level, start}; }

  std::size_t from, count;
  std::span<const Column> columns;
  std::vector<Coupling> couplings;
  Start start;
  int level;
};

std::vector<Part> parts(const Clip& clip) {
  std::vector<Part> made;
  for (std::size_t from = 0; from < clip.columns.size(); from += kTogether) {
    made.emplace_back(clip, from, std::min(from + kTogether, clip.columns.size()));
  }
  return made;
}

}  // namespace

Bytes encode(const double* values, std::size_t frames, const Clip& clip, Start* learned,
             std::vector<float>* seen, std::size_t* early) {
  if (early != nullptr) *early = 0;
  if (clip.level <= kFastLevels) return encode_fast(values, frames, clip, learned);
  RangeWriting side;
  const std::size_t count = clip.columns.size();
  std::vector<bool> cuts(frames);
  for (std::size_t f = 0; f < frames; ++f) cuts[f] = is_cut(values, frames, count, f);
  for (const Part& part : parts(clip)) {
    Model model(part.clip());
    model.show_network(seen);
    std::vector<double> row(part.count);
    const std::size_t before = side.size();
    for (std::size_t f = 0; f < frames; ++f) {
      std::copy_n(values + f * count + part.from, part.count, row.data());
      model.code_frame(side, row.data(), cuts[f]);
      if (early != nullptr && f + 1 == std::min(frames, kEarly)) *early += side.size() - before;
    }
    if (learned == nullptr) continue;
    Start own = model.learned();
    learned->shared = std::move(own.shared);
    std::ranges::move(own.columns, std::back_inserter(learned->columns));
  }
  return side.finish();
}

void decode(ByteView payload, double* values, std::size_t frames, const Clip& clip, bool whole) {
  if (clip.level <= kFastLevels) return decode_fast(payload, values, frames, clip, whole);
  RangeReading side(payload);
  for (const Part& part : parts(clip)) {
    if (!side.sound()) break;
    Model model(part.clip());
    for (std::size_t f = 0; f < frames; ++f) {
      if (f % kSoundEvery == 0 && !side.sound()) break;
      model.code_frame(side, values + f * clip.columns.size() + part.from, false);
    }
  }
  if (whole ? !side.exhausted() : !side.sound()) {
    fail("the payload does not decode");
  }
}

}  // namespace mocapress::exact
