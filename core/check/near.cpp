// Prints digests of made-up payloads of `near` and of what they decode to, to compare builds with
// each other. What the encoder makes of motion may differ: it weighs with the library's logarithms.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "check/motion.hpp"
#include "coding/sides.hpp"
#include "near/codec.hpp"
#include "near/coder.hpp"
#include "near/marks.hpp"
#include "near/start.hpp"

namespace near = mocapress::near;
namespace check = mocapress::check;

namespace {

constexpr std::size_t kFrames = 600, kChannels = 12;

near::Plan plan_of() {
  near::Plan plan;
  plan.knot = 0.75;
  for (std::size_t c = 0; c < kChannels; ++c) {
    plan.steps.push_back(near::step_of(static_cast<int>(32 * (c % 5)) - 300));
    plan.joints.of_column.push_back(static_cast<std::int32_t>(c / 3));
  }
  plan.joints.parents = {-1, 0, 1, 0};
  plan.turnings = {{0, 5, 5, 2, true}, {3, 0, 3, 4, false}};
  return plan;
}

// A chunk of numbers drawn at random, as an encoder would write them.
class Writer {
 public:
  explicit Writer(std::uint64_t seed) : random_(seed) {}

  mocapress::Bytes payload(const near::Plan& plan) {
    if (plan.start != nullptr) coder_ = near::Coder(plan.start->models);
    mocapress::Bit moves[2];
    mocapress::Difference<6> firsts;
    bool moved = true;
    for (std::size_t c = 0; c < kChannels; ++c) {
      moved = side_.bit(moves[moved ? 1 : 0], c % 7 != 6);
      firsts.code(side_, random_.around(100000));
      if (moved) coder_.channels.emplace_back().index = c;
    }
    near::code_starts(side_, plan, {{}, {100, -50, 200}});
    int length = 0;
    for (std::size_t first = 0; first < kFrames; first += static_cast<std::size_t>(length)) {
      length = near::span_of(true, kFrames - first);
      for (std::size_t i = 0; i < coder_.channels.size(); ++i) {
        coder_.channels[i].begin_span(length);
        part(i, 0, length);
      }
    }
    near::Marks marks(side_, kFrames, kChannels);
    marks.corrections({{3, 1, {{0, 5}, {4, -1}}}, {500, 9, {{11, 700}}}},
                      [](const near::Correction&) {});
    marks.kept({{2, 7, {1, 1, 0x7ff8000000000000}}, {2, 20, {5}}, {9, 0, {5}}},
               [](std::size_t, std::size_t, double) {});
    return side_.finish();
  }

 private:
  void part(std::size_t i, int start, int length) {
    near::Channel& channel = coder_.channels[i];
    const near::Block* const before = channel.blocks.empty() ? nullptr : &channel.blocks.back();
    const near::Around around = coder_.around(i, before, start, length);
    const bool is_split = random_.around(9) > 2;
    if (length > near::kShortest && coder_.split<near::Narrow>(side_, around, length, is_split)) {
      part(i, start, length / 2);
      part(i, start + length / 2, length / 2);
      return;
    }
    std::vector<std::int32_t> numbers(static_cast<std::size_t>(length));
    near::Block block{start, length, static_cast<int>(random_.next() % 9), numbers.data()};
    block.of_class = std::min(block.of_class, near::classes_of(length) - 1);
    for (int k = 0; k <= near::end_of(block.of_class, length); ++k) {
      const auto most = random_.around(20) == 0 ? 5000 : 60 / (k + 2);
      block.numbers[k] = static_cast<std::int32_t>(random_.around(most));
    }
    coder_.code<near::Narrow>(side_, i, around, block);
    channel.blocks.push_back(block);
  }

  check::Random random_;
  mocapress::RangeWriting side_;
  near::Coder coder_;
};

}  // namespace

int main() {
  near::Plan plan = plan_of();
  check::report("near, steps", plan.steps);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    if (seed == 4) plan.start = &near::start_of(1, true);
    const auto payload = Writer(seed).payload(plan);
    std::vector<double> decoded(kFrames * kChannels);
    near::decode(payload, decoded.data(), kFrames, plan);
    const std::string what = "near, numbers " + std::to_string(seed);
    check::report(what, payload, decoded, decoded);
    check::report(what + ", values", decoded);
  }
  return 0;
}
