#include "patterns/codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "coding/fail.hpp"
#include "coding/numbers.hpp"
#include "coding/sides.hpp"
#include "patterns/numbers.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// As in core/motion/kinematics.cpp: no fused operations of sums and differences side by side.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress::patterns {
namespace {

std::int64_t steps_of(double value, double step, double rounding = 0.5) {
  const double steps = std::floor(std::fabs(value) / step + rounding);
  const auto most = static_cast<double>(kMostNumber);
  const auto whole = static_cast<std::int64_t>(std::min(steps, most));
  return value < 0 ? -whole : whole;
}

// Both directions of a chunk: the writing side finds what it codes in `given`, the reading side has
// none; both fill `values`.
template <class Side>
class Chunk {
 public:
  Chunk(Side& side, const Plan& plan, std::size_t frames, double* values, const Given* given)
      : side_(side),
        plan_(plan),
        frames_(frames),
        columns_(plan.roles.size()),
        values_(values),
        given_(given) {}

  void code() {
    enter(Part::tracks);
    for (std::size_t c = 0; c < columns_; ++c) {
      if (plan_.roles[c] == Role::track) code_track(c, plan_.track);
      if (plan_.roles[c] == Role::protected_track) code_track(c, plan_.protected_track);
    }
    const double* projection = Side::kReading ? nullptr : given_->projections.data();
    for (std::size_t n = 0; n < plan_.nodes.size(); ++n) {
      code_node(n, projection);
      if constexpr (!Side::kReading) {
        projection += plan_.nodes[n].components * plan_.nodes[n].columns.size();
      }
    }
    for (std::size_t c = 0; c < columns_; ++c) {
      if (plan_.roles[c] != Role::copy) continue;
      for (std::size_t t = 0; t < frames_; ++t) at(t, c) = at(t, plan_.references[c]);
    }
    enter(Part::corrections);
    code_corrections();
  }

 private:
  // What is coded from here on, for a side that counts.
  void enter(Part part) {
    if constexpr (requires { side_.enter(part); }) side_.enter(part);
  }

  double& at(std::size_t frame, std::size_t column) { return values_[frame * columns_ + column]; }

  void check() {
    if constexpr (Side::kReading) {
      if (!side_.sound()) fail("a payload that is cut off");
    }
  }

  void code_track(std::size_t c, double step) {
    std::array<Usual, 7> usual;
    Usual count(16 * 4);
    double last = 0;
    for (std::size_t begin = 0; begin < frames_; begin += kMostFrames) {
      const std::size_t size = std::min(kMostFrames, frames_ - begin);
      // Blocks of other lengths than 64 are the last.
      const Cosines own = size == kMostFrames ? Cosines(0) : Cosines(size);
      const Cosines& cosines = size == kMostFrames ? plan_.cosines[kMostFrames] : own;
      std::array<std::int64_t, kMostFrames> terms{};
      std::size_t terms_count = 0;
      if constexpr (!Side::kReading) {
        for (std::size_t k = 0; k < size; ++k) {
          double sum = 0;
          for (std::size_t t = 0; t < size; ++t) {
            sum += (given_->filled[(begin + t) * columns_ + c] - last) * cosines.of(k)[t];
          }
          terms[k] = steps_of(sum, step, k == 0 ? 0.5 : 0.4);
          if (terms[k] != 0) terms_count = k + 1;
        }
      }
      terms_count = counts_.count(side_, count, terms_count);
      if (terms_count > size) fail("a block of more terms than frames");
      std::array<double, kMostFrames> curve;
      curve.fill(last);
      for (std::size_t k = 0; k < terms_count; ++k) {
        const auto place = static_cast<std::size_t>(std::bit_width(k));
        const std::int64_t term = terms_.number(side_, usual[place], terms[k]);
        if (term == 0) continue;
        const double part = static_cast<double>(term) * step;
        for (std::size_t t = 0; t < size; ++t) curve[t] += part * cosines.of(k)[t];
      }
      for (std::size_t t = 0; t < size; ++t) at(begin + t, c) = curve[t];
      last = curve[size - 1];
      check();
    }
  }

  // Frames x components: how far each component is from the target, on the writing side.
  std::vector<double> targets(const Node& node, const double* projection) {
    const std::size_t size = node.columns.size(), count = node.components;
    std::vector<double> found(frames_ * count), moved(size);
    for (std::size_t t = 0; t < frames_; ++t) {
      for (std::size_t i = 0; i < size; ++i) {
        const std::size_t c = node.columns[i], from = plan_.references[c];
        moved[i] = given_->filled[t * columns_ + c];
        if (from != Plan::kNone) moved[i] -= at(t, from);
        if (!plan_.published) moved[i] -= centre(node, i);
      }
      for (std::size_t j = 0; j < count; ++j) {
        double sum = plan_.published ? moved[j] : 0;
        for (std::size_t i = 0; i < size && !plan_.published; ++i) {
          sum += projection[j * size + i] * moved[i];
        }
        found[t * count + j] = sum;
      }
    }
    return found;
  }

  double centre(const Node& node, std::size_t i) const {
    return static_cast<double>(node.centre[i]) * plan_.pattern;
  }

  void code_node(std::size_t index, const double* projection) {
    const Node& node = plan_.nodes[index];
    const std::size_t count = node.components;
    std::vector<double> moved(frames_ * count), shape(node.frames * count), target;
    if constexpr (!Side::kReading) target = targets(node, projection);
    std::vector<Usual> usual(count, Usual(16));
    Usual length(16 * 16), pattern(16 * 4);
    std::vector<std::size_t> boundaries;
    std::size_t begin = 0;
    for (std::size_t s = 0; begin < frames_; ++s) {
      std::size_t size = Side::kReading ? 0 : given_->segments[index].frames[s] - 1;
      enter(Part::lengths);
      size = lengths_.count(side_, length, size);
      if (size >= frames_ - begin) fail("a segment of more frames than are left");
      ++size;
      std::size_t own = Side::kReading ? 0 : given_->segments[index].patterns[s];
      enter(Part::indices);
      if (node.patterns > 1) own = patterns_.count(side_, pattern, own);
      if (own >= node.patterns) fail("a pattern that the database lacks");
      shape_of(plan_, index, own, shape.data());
      stretch(shape.data(), node.frames, moved.data() + begin * count, size, count);
      enter(Part::places);
      if (plan_.apart) {
        const double step = plan_.place / node.importance;
        for (std::size_t j = 0; j < count; ++j) {
          place(moved.data(), target.data(), begin, size, j, count, step, usual[j]);
        }
      }
      begin += size;
      boundaries.push_back(begin);
      check();
    }
    if (!boundaries.empty()) boundaries.pop_back();
    smooth(moved, boundaries, count);
    write(node, moved);
  }

  // A pattern of `from` frames in `to` frames, by linear interpolation.
  static void stretch(const double* shape, std::size_t from, double* moved, std::size_t to,
                      std::size_t count) {
    for (std::size_t t = 0; t < to; ++t) {
      const std::size_t scaled = t * (from - 1);
      const std::size_t frame = to > 1 ? scaled / (to - 1) : 0;
      const std::size_t rest = to > 1 ? scaled % (to - 1) : 0;
      for (std::size_t j = 0; j < count; ++j) {
        const double first = shape[frame * count + j];
        double& own = moved[t * count + j];
        own = first;
        if (rest == 0) continue;
        const double part = static_cast<double>(rest) / static_cast<double>(to - 1);
        own = first + (shape[(frame + 1) * count + j] - first) * part;
      }
    }
  }

  // Moves component j of a segment from where it is expected, going on from the one before.
  void place(double* moved, const double* target, std::size_t begin, std::size_t size,
             std::size_t j, std::size_t count, double step, Usual& usual) {
    double* const own = moved + begin * count + j;
    double expected = 0;
    if (begin > 0) {
      const double last = own[-static_cast<std::ptrdiff_t>(count)];
      double speed = size > 1 ? own[count] - own[0] : 0.0;
      if (begin > 1) speed += last - own[-static_cast<std::ptrdiff_t>(2 * count)];
      expected = (last - own[0]) + speed * 0.5;
    }
    std::int64_t steps = 0;
    if constexpr (!Side::kReading) {
      double sum = 0;
      for (std::size_t t = 0; t < size; ++t) {
        sum += target[(begin + t) * count + j] - own[t * count];
      }
      steps = steps_of(sum / static_cast<double>(size) - expected, step);
    }
    steps = places_.number(side_, usual, steps);
    const double by = expected + static_cast<double>(steps) * step;
    for (std::size_t t = 0; t < size; ++t) own[t * count] += by;
  }

  // The filter 1 4 6 4 1 around boundaries.
  void smooth(std::vector<double>& moved, const std::vector<std::size_t>& boundaries,
              std::size_t count) {
    if (plan_.smoothed == 0 || boundaries.empty() || count == 0) return;
    const std::vector<double> before = moved;
    std::size_t done = 0;
    for (const std::size_t boundary : boundaries) {
      const std::size_t first = std::max(done, boundary - std::min(boundary, plan_.smoothed));
      const std::size_t last = std::min(frames_, boundary + plan_.smoothed);
      for (std::size_t t = first; t < last; ++t) {
        const std::size_t up1 = std::min(t + 1, frames_ - 1), up2 = std::min(t + 2, frames_ - 1);
        const std::size_t down1 = t - std::min<std::size_t>(t, 1);
        const std::size_t down2 = t - std::min<std::size_t>(t, 2);
        for (std::size_t j = 0; j < count; ++j) {
          const auto of = [&](std::size_t frame) { return before[frame * count + j]; };
          const double far = of(down2) + of(up2), near = of(down1) + of(up1);
          moved[t * count + j] = ((far + near * 4) + of(t) * 6) / 16;
        }
      }
      done = last;
    }
  }

  void write(const Node& node, const std::vector<double>& moved) {
    const std::size_t size = node.columns.size(), count = node.components;
    std::vector<double> basis(node.basis.size());
    for (std::size_t i = 0; i < basis.size(); ++i) {
      basis[i] = static_cast<double>(node.basis[i]) / kBasisSteps;
    }
    for (std::size_t t = 0; t < frames_; ++t) {
      const double* const own = moved.data() + t * count;
      for (std::size_t i = 0; i < size; ++i) {
        const std::size_t c = node.columns[i], from = plan_.references[c];
        double sum = plan_.published ? own[i] : centre(node, i);
        for (std::size_t j = 0; j < count && !plan_.published; ++j) {
          sum += own[j] * basis[j * size + i];
        }
        at(t, c) = from == Plan::kNone ? sum : at(t, from) + sum;
      }
    }
  }

  // Of a value: its correction goes on, it has another, it is the number that was kept before, or
  // one that is kept now.
  enum Kind : unsigned { kSame, kOther, kKeptBefore, kKeptNow };
  struct Correction {
    Kind kind = kSame;
    std::int64_t number = 0;  // change of the correction, in steps, or the kept bits
  };

  double step_of_corrections(std::size_t c) const {
    const bool own = plan_.roles[c] == Role::protected_track;
    return own ? plan_.protected_correction : plan_.correction;
  }

  void code_corrections() {
    std::array<Tally, 2> any;
    std::array<BitTree<2>, 4> kinds;
    Numbers changes;
    std::vector<std::vector<Correction>> chosen(columns_);
    bool found = false;
    if constexpr (!Side::kReading) {
      for (std::size_t c = 0; c < columns_; ++c) {
        chosen[c] = corrections(c);
        found = found || !chosen[c].empty();
      }
    }
    if (!any[0].code(side_, found)) return;
    for (std::size_t c = 0; c < columns_; ++c) {
      if (!any[1].code(side_, !chosen[c].empty())) continue;
      const double step = step_of_corrections(c);
      Usual usual(16);
      std::uint64_t held = 0;
      std::int64_t steps = 0;
      unsigned before = kSame;
      for (std::size_t t = 0; t < frames_; ++t) {
        const Correction own = Side::kReading ? Correction{} : chosen[c][t];
        before = kinds[before].code(side_, own.kind);
        if (before == kOther) {
          steps += changes.number(side_, usual, own.number);
          if (steps > kMostNumber || steps < -kMostNumber) fail("a correction out of range");
        } else if (before == kKeptNow) {
          held = side_.raw(64, static_cast<std::uint64_t>(own.number));
        }
        const bool kept = before == kKeptBefore || before == kKeptNow;
        at(t, c) = kept ? std::bit_cast<double>(held) : corrected(at(t, c), steps, step);
      }
      check();
    }
  }

  static double corrected(double value, std::int64_t steps, double step) {
    return steps == 0 ? value : value + static_cast<double>(steps) * step;
  }

  // What a column needs; nothing where nothing is to be corrected.
  std::vector<Correction> corrections(std::size_t c) const {
    const double step = step_of_corrections(c);
    const bool own = plan_.roles[c] == Role::protected_track;
    const double most = own ? given_->protected_error : given_->max_error;
    std::vector<Correction> found(frames_);
    bool any = false;
    std::int64_t steps = 0;
    std::uint64_t held = 0;
    for (std::size_t t = 0; t < frames_; ++t) {
      const std::size_t i = t * columns_ + c;
      const double value = given_->original[i], base = values_[i];
      const auto fits = [&](std::int64_t by) {
        return std::fabs(value - corrected(base, by, step)) <= most;
      };
      if (given_->kept[i] == 0 && fits(steps)) continue;
      any = true;
      const bool may = given_->kept[i] == 0 && step > 0;
      const std::int64_t other = may ? steps_of(value - base, step) : 0;
      if (may && other != kMostNumber && other != -kMostNumber && fits(other)) {
        found[t] = {kOther, other - steps};
        steps = other;
        continue;
      }
      const auto bits = std::bit_cast<std::uint64_t>(value);
      found[t] = {bits == held ? kKeptBefore : kKeptNow, static_cast<std::int64_t>(bits)};
      held = bits;
    }
    if (!any) found.clear();
    return found;
  }

  Side& side_;
  const Plan& plan_;
  std::size_t frames_, columns_;
  double* values_;
  const Given* given_;
  Numbers counts_, terms_, lengths_, patterns_, places_;
};

// Reads, and counts the bits of each part.
class Counting {
 public:
  static constexpr bool kReading = true;

  explicit Counting(ByteView payload) : side_(payload) {}

  void enter(Part part) { part_ = static_cast<std::size_t>(part); }
  bool chance(std::uint32_t zero, bool ignored) {
    const bool one = side_.chance(zero, ignored);
    bits_[part_] -= std::log2((one ? 65536 - zero : zero) / 65536.0);
    return one;
  }
  bool bit(Bit& model, bool ignored) {
    const std::uint32_t zero = model.chance_of_zero();
    const bool one = side_.bit(model, ignored);
    bits_[part_] -= std::log2((one ? 65536 - zero : zero) / 65536.0);
    return one;
  }
  std::uint64_t raw(int count, std::uint64_t ignored) {
    bits_[part_] += count;
    return side_.raw(count, ignored);
  }
  bool sound() const { return side_.sound(); }
  const std::array<double, kParts>& bits() const { return bits_; }

 private:
  RangeReading side_;
  std::array<double, kParts> bits_{};
  std::size_t part_ = 0;
};

}  // namespace

void decode(ByteView payload, double* values, std::size_t frames, const Plan& plan) {
  RangeReading side(payload);
  Chunk chunk(side, plan, frames, values, nullptr);
  chunk.code();
  if (!side.exhausted()) fail("a payload that does not end where it should");
}

std::array<double, kParts> bits_of(ByteView payload, std::size_t frames, const Plan& plan) {
  Counting side(payload);
  std::vector<double> values(frames * plan.roles.size());
  Chunk chunk(side, plan, frames, values.data(), nullptr);
  chunk.code();
  return side.bits();
}

Bytes encode(const Given& given, std::size_t frames, const Plan& plan) {
  RangeWriting side;
  std::vector<double> values(frames * plan.roles.size());
  Chunk chunk(side, plan, frames, values.data(), &given);
  chunk.code();
  return side.finish();
}

}  // namespace mocapress::patterns
