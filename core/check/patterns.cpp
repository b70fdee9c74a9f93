// Prints digests of databases and payloads of patterns and of what they decode to, in both forms of
// patterns, with and without corrections.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "check/motion.hpp"
#include "patterns/codec.hpp"

namespace patterns = mocapress::patterns;
namespace check = mocapress::check;
using mocapress::Bytes;

namespace {

constexpr std::size_t kFrames = 300, kColumns = 12, kPatterns = 5;
constexpr double kMaxError = 0.5;

void put_double(Bytes& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 0; i < 64; i += 8) bytes.push_back(static_cast<std::uint8_t>(bits >> i));
}

// Two tracks, a protected one, nodes of six columns and of two, and a copy.
Bytes body(bool apart, bool published) {
  Bytes bytes = {kColumns, 0, 2, 1, 1, 3, 6, 4, 2, 2, 1, 0, 3, 6, 3, 12, 6};
  bytes.push_back(static_cast<std::uint8_t>((apart ? 1 : 0) | (published ? 2 : 0)));
  put_double(bytes, 0.25);
  for (const std::uint8_t fact : {9, static_cast<int>(kPatterns), published ? 6 : 4, 16}) {
    bytes.push_back(fact);
  }
  for (const std::uint8_t fact : {4, 1, 2, 40}) bytes.push_back(fact);
  return bytes;
}

// Patterns of made-up numbers.
Bytes with_database(const Bytes& alone) {
  auto plan = patterns::read_body_alone(alone, kColumns);
  check::Random random(7);
  for (patterns::Node& node : plan.nodes) {
    const std::size_t size = node.columns.size(), series = node.patterns * node.components;
    for (std::size_t i = 0; i < node.components * size; ++i) {
      node.basis.push_back(random.around(512));
    }
    for (std::size_t i = 0; i < size; ++i) node.centre.push_back(random.around(100));
    node.starts.assign(1, 0);
    for (std::size_t s = 0; s < series; ++s) {
      for (std::size_t k = 0; k < s % node.frames; ++k) node.terms.push_back(random.around(9));
      if (s % node.frames > 0) node.terms.back() = 1;
      node.starts.push_back(static_cast<std::uint32_t>(node.terms.size()));
      node.first.push_back(random.around(1000));
    }
    for (std::size_t p = 0; p < node.patterns; ++p) {
      node.quantisers.insert(node.quantisers.end(), {-3.0F, 0.0234375F});
    }
    for (std::size_t i = 0; i < series * (node.frames - 1); ++i) {
      node.differences.push_back(static_cast<std::uint8_t>(random.next()));
    }
  }
  const Bytes coded = patterns::write_database(plan);
  std::printf("patterns, database: %zu bytes, %016llx\n", coded.size(),
              static_cast<unsigned long long>(check::digest(coded.data(), coded.size())));
  Bytes whole = alone;
  for (std::size_t size = coded.size();; size >>= 7) {
    whole.push_back(static_cast<std::uint8_t>(size >= 0x80 ? size | 0x80 : size));
    if (size < 0x80) break;
  }
  whole.insert(whole.end(), coded.begin(), coded.end());
  return whole;
}

Bytes header_of(bool learned, double max_error) {
  Bytes bytes = {static_cast<std::uint8_t>(learned ? 1 : 0)};
  for (const double step : {0.0, 0.5, 0.75, 0.25, 1.9 * max_error, 0.95 * max_error}) {
    put_double(bytes, step);
  }
  bytes.push_back(2);  // smoothed
  return bytes;
}

bool check_one(const std::string& name, const std::vector<double>& values,
               const patterns::Plan& plan, double max_error) {
  const std::size_t frames = values.size() / kColumns;
  std::vector<double> filled = values, projections;
  std::vector<std::uint8_t> kept(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::fabs(values[i]) < 1e12) continue;
    filled[i] = 0;
    kept[i] = 1;
  }
  std::vector<patterns::Segments> segments(plan.nodes.size());
  for (std::size_t n = 0; n < segments.size(); ++n) {
    std::size_t left = frames;
    for (std::size_t s = 0; left > 0; ++s) {
      segments[n].frames.push_back(std::min(left, 1 + (s * 7) % 19));
      segments[n].patterns.push_back(s % plan.nodes[n].patterns);
      left -= segments[n].frames.back();
    }
    for (const std::int64_t part : plan.nodes[n].basis) {
      projections.push_back(static_cast<double>(part) / 1024);
    }
    projections.resize(
        projections.size() +
        (plan.published ? plan.nodes[n].components * plan.nodes[n].columns.size() : 0));
  }
  const patterns::Given given = {values.data(), filled.data(), kept.data(),  segments,
                                 projections,   max_error,     max_error / 2};
  const Bytes payload = patterns::encode(given, frames, plan);
  std::vector<double> decoded(values.size());
  patterns::decode(payload, decoded.data(), frames, plan);
  std::printf("patterns, %s: %zu bytes, %016llx\n", name.c_str(), payload.size(),
              static_cast<unsigned long long>(check::digest(payload.data(), payload.size())));
  check::report("patterns, " + name + ", values", decoded);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && !(std::fabs(values[i] - decoded[i]) <= max_error)) return false;
  }
  return true;
}

}  // namespace

int main() {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  bool same = true;
  auto motion = check::motion(kFrames, kColumns, 1);
  for (std::size_t t = 0; t < kFrames; ++t) motion[t * kColumns + 11] = motion[t * kColumns + 5];
  const auto noise = check::noise(60 * kColumns, 2);
  for (const bool apart : {false, true}) {
    for (const bool published : {false, true}) {
      const Bytes own = with_database(body(apart, published));
      const std::string name =
          std::string(apart ? "apart" : "together") + (published ? ", published" : ", cosines");
      Bytes header = header_of(false, kMaxError);
      header.insert(header.end(), own.begin(), own.end());
      const auto plan = patterns::read_plan(header, {}, kColumns);
      Bytes model = {0};
      model.insert(model.end(), own.begin(), own.end());
      const auto learned = patterns::read_plan(header_of(true, 0), model, kColumns);
      same &= check_one("motion, " + name, motion, learned, kAny);
      same &= check_one("bounded, " + name, motion, plan, kMaxError);
      same &= check_one("noise, " + name, noise, plan, kMaxError);
    }
  }
  return same ? 0 : 1;
}
