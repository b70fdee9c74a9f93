// Prints digests of payloads of QSSD and of what they decode to, with and without atoms; and of
// weights and a dictionary learned from made-up turns.
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "check/motion.hpp"
#include "qssd/codec.hpp"
#include "qssd_learning/encoder.hpp"
#include "qssd_learning/products.hpp"
#include "qssd_learning/sums.hpp"

namespace qssd = mocapress::qssd;
namespace check = mocapress::check;
using mocapress::Bytes;

namespace {

constexpr std::size_t kFrames = 300, kColumns = 12, kJoints = 4, kAtoms = 5;
constexpr double kMaxError = 0.25;

void put_double(Bytes& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 0; i < 64; i += 8) bytes.push_back(static_cast<std::uint8_t>(bits >> i));
}

// One number, joints of three, of three, of two and of three turns.
Bytes body(bool reversed) {
  Bytes bytes = {kColumns};
  for (const std::uint8_t role : {0, 1, 5, 6, 3, 4, 5, 1, 6, 2, 4, 6}) {
    bytes.push_back(role);
    bytes.push_back(1);
  }
  bytes.push_back(reversed ? 1 : 0);
  for (std::size_t j = 0; j < kJoints; ++j) {
    bytes.push_back(static_cast<std::uint8_t>(100 - 20 * j));  // importance
    for (const std::uint8_t part : {100, 20, 3, 0}) bytes.push_back(part);
  }
  for (const std::uint8_t part : {0, 5, 7}) bytes.push_back(part);  // the number
  return bytes;
}

qssd::Plan plan_of(bool learned, bool reversed, double patch) {
  Bytes header = {static_cast<std::uint8_t>(learned ? 1 : 0), 5, 1};
  put_double(header, 0.3);
  put_double(header, patch);
  Bytes model = body(reversed);
  if (!learned) header.insert(header.end(), model.begin(), model.end());
  model.push_back(kAtoms);
  check::Random random(3);
  for (std::size_t i = 0; i < kAtoms * kJoints * 3; ++i) {
    model.push_back(static_cast<std::uint8_t>(random.next() % 100));
  }
  model.push_back(0);
  return qssd::read_plan(header, learned ? model : Bytes{}, kColumns);
}

bool check_one(const std::string& name, const std::vector<double>& values, const qssd::Plan& plan,
               double max_error) {
  const std::size_t frames = values.size() / kColumns;
  const std::vector<double> limits(values.size(), max_error);
  const auto payload =
      qssd::encode_chunk(values.data(), frames, plan, {4, 0.4, 0.3}, limits.data());
  std::vector<double> decoded(values.size());
  qssd::decode(payload, decoded.data(), frames, plan);
  std::printf("qssd, %s: %zu bytes, %016llx\n", name.c_str(), payload.size(),
              static_cast<unsigned long long>(check::digest(payload.data(), payload.size())));
  check::report("qssd, " + name + ", values", decoded);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && !(std::fabs(values[i] - decoded[i]) <= max_error)) return false;
  }
  return true;
}

void check_learning() {
  constexpr std::size_t kSamples = 100, kMost = 3;
  std::vector<double> turns, dictionary;
  const auto numbers = check::motion(kSamples, 4 * kJoints, 5);
  for (std::size_t i = 0; i < kSamples * kJoints; ++i) {
    const double* own = numbers.data() + 4 * i;
    const auto turn = qssd::exponential(own[0] / 100, own[1] / 100, own[2] / 100);
    turns.insert(turns.end(), turn.begin(), turn.end());
  }
  for (std::size_t i = 0; i < kAtoms * kJoints * 3; ++i) {
    dictionary.push_back(std::fabs(numbers[7 * i]) > 0 ? std::fmod(numbers[7 * i], 1) : 0.5);
  }
  const std::array importance = {1.0, 3.0, 0.5, 2.0};
  std::vector<std::int32_t> atoms(kSamples * kMost, -1);
  std::vector<double> weights(kSamples * kMost);
  const qssd::Frames frames = {turns.data(), kSamples, kJoints, importance.data()};
  const qssd::Dictionary known = {dictionary.data(), kAtoms};
  const qssd::Weights picked = {atoms.data(), weights.data(), kMost};
  for (const auto order : {qssd::Order::stop, qssd::Order::sort}) {
    atoms.assign(atoms.size(), -1);
    weights.assign(weights.size(), 0);
    qssd::code_by_products(frames, known, picked, {0, 0}, order);
    check::report("qssd, weights", weights);
    qssd::learn_products(frames, known, picked);
    check::report("qssd, dictionary", dictionary);
  }
  atoms.assign(atoms.size(), -1);
  qssd::code_by_sums(turns.data(), kSamples, kJoints * 3, known, picked, 0);
  qssd::learn_sums(turns.data(), kSamples, kJoints * 3, known, picked);
  check::report("K-SVD, dictionary", dictionary);
}

}  // namespace

int main() {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  bool same = true;
  const auto motion = check::motion(kFrames, kColumns, 1);
  const auto noise = check::noise(60 * kColumns, 2);
  for (const bool learned : {false, true}) {
    for (const bool reversed : {false, true}) {
      const std::string name = std::string(learned ? "atoms" : "no atoms") +
                               (reversed ? ", last turn first" : ", first turn first");
      same &= check_one("motion, " + name, motion, plan_of(learned, reversed, 0), kAny);
      same &= check_one("bounded, " + name, motion, plan_of(learned, reversed, 0.4), kMaxError);
      same &= check_one("noise, " + name, noise, plan_of(learned, reversed, 0.4), kMaxError);
    }
  }
  check_learning();
  return same ? 0 : 1;
}
