#include "patterns/plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "coding/fail.hpp"
#include "coding/numbers.hpp"
#include "coding/record.hpp"
#include "coding/sides.hpp"
#include "patterns/numbers.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// As in core/motion/kinematics.cpp: no fused operations of sums and differences side by side.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress::patterns {
namespace {

double positive(Record& record) {
  const double step = record.number();
  if (!(step >= 1e-9 && step <= 1e9)) fail("a step that is none");
  return step;
}

void read_columns(Plan& plan, Record& record, std::size_t columns) {
  if (record.integer() != columns) fail("a header of other columns");
  const auto roles = record.runs(columns, columns + 2);
  const auto references = record.runs(columns, 2 * columns + 1);
  std::uint64_t most = 0;
  for (const std::uint64_t role : roles) most = std::max(most, role);
  plan.nodes.resize(most > 2 ? most - 2 : 0);
  plan.references.assign(columns, Plan::kNone);
  for (std::size_t c = 0; c < columns; ++c) {
    plan.roles.push_back(static_cast<Role>(std::min<std::uint64_t>(roles[c], 3)));
    if (roles[c] > 2) plan.nodes[roles[c] - 3].columns.push_back(c);
    if (references[c] == 0) {
      if (roles[c] == 2) fail("a copy of nothing");
      continue;
    }
    const auto zigzag = references[c];
    const auto back =
        static_cast<std::int64_t>(zigzag >> 1) ^ -static_cast<std::int64_t>(zigzag & 1);
    const auto from = static_cast<std::int64_t>(c) - back;
    if (from < 0 || from >= static_cast<std::int64_t>(columns)) fail("a reference to no column");
    // What is decoded later, or is a copy, cannot be referred to; a track refers to nothing.
    const auto target = roles[static_cast<std::size_t>(from)];
    const bool known = target < 2 || (target > 2 && (roles[c] == 2 || target < roles[c]));
    if (roles[c] < 2 || !known) fail("a reference to a column that is decoded later");
    plan.references[c] = static_cast<std::size_t>(from);
  }
}

void read_nodes(Plan& plan, Record& record) {
  const std::uint64_t flags = record.integer(3);
  plan.apart = (flags & 1) != 0;
  plan.published = (flags & 2) != 0;
  plan.pattern = positive(record);
  for (Node& node : plan.nodes) {
    const std::size_t size = node.columns.size();
    if (size == 0) fail("a node without columns");
    node.frames = record.integer(kMostFrames);
    node.patterns = record.integer(65536);
    node.components = record.integer(plan.published ? size : std::min(size, kMostComponents));
    if (node.frames == 0 || node.patterns == 0) fail("a node without patterns");
    if (plan.published && node.components != size) fail("a node of other components than columns");
    const std::uint64_t importance = record.integer(1 << 20);
    if (importance == 0) fail("a node of no importance");
    node.importance = static_cast<double>(importance) / 16;
  }
}

// What a pattern of either kind is, once for reading and writing.
template <class Side>
class Database {
 public:
  explicit Database(Side& side, std::size_t bytes) : side_(side), bytes_(bytes) {}

  void code(Node& node, bool published) {
    if (published) {
      code_published(node);
    } else {
      code_all(bases_, node.basis, node.components * node.columns.size(), Usual(16 * 64));
      code_all(centres_, node.centre, node.columns.size(), Usual(16 * 16));
      code_cosines(node);
    }
  }

 private:
  void code_all(Numbers& numbers, std::vector<std::int64_t>& all, std::size_t count, Usual usual) {
    all.resize(count);
    for (std::int64_t& one : all) one = numbers.number(side_, usual, one);
  }

  void check() {
    if constexpr (Side::kReading) {
      if (!side_.sound()) fail("a database that is cut off");
    }
  }

  void code_cosines(Node& node) {
    // No two patterns are alike, and a sign costs a bit.
    if (node.patterns > 1 + 8 * bytes_) fail("more patterns than bytes can tell");
    const std::size_t series = node.patterns * node.components;
    std::vector<Usual> counts(node.components, Usual(16 * 2));
    std::vector<Usual> usual(node.components * 7, Usual(16));
    if constexpr (Side::kReading) node.starts.assign(1, 0);
    for (std::size_t s = 0; s < series; ++s) {
      const std::size_t j = s % node.components;
      std::size_t count = Side::kReading ? 0 : node.starts[s + 1] - node.starts[s];
      count = counts_.count(side_, counts[j], count);
      if (count > node.frames) fail("a pattern of more terms than frames");
      for (std::size_t k = 0; k < count; ++k) {
        const std::int64_t term = Side::kReading ? 0 : node.terms[node.starts[s] + k];
        const auto place = static_cast<std::size_t>(std::bit_width(k));
        const std::int64_t coded = terms_.number(side_, usual[j * 7 + place], term);
        if constexpr (Side::kReading) node.terms.push_back(coded);
      }
      if constexpr (Side::kReading) {
        if (count > 0 && node.terms.back() == 0) fail("a pattern with a term too many");
        node.starts.push_back(static_cast<std::uint32_t>(node.terms.size()));
      }
      if (s % 256 == 255) check();
    }
    check();
  }

  void code_published(Node& node) {
    if (node.patterns > 1 + bytes_ / 8) fail("more patterns than bytes can tell");
    const std::size_t differences = (node.frames - 1) * node.components;
    node.quantisers.resize(2 * node.patterns);
    for (std::size_t p = 0; p < node.patterns; ++p) {
      for (std::size_t i = 0; i < 2; ++i) {
        float& own = node.quantisers[2 * p + i];
        own = std::bit_cast<float>(
            static_cast<std::uint32_t>(side_.raw(32, std::bit_cast<std::uint32_t>(own))));
        if (!(std::fabs(own) < 1e12F)) fail("a quantiser that is none");
      }
      for (std::size_t j = 0; j < node.components; ++j) {
        const std::int64_t own = Side::kReading ? 0 : node.first[p * node.components + j];
        const std::int64_t coded = firsts_.number(side_, first_, own);
        if constexpr (Side::kReading) node.first.push_back(coded);
      }
      for (std::size_t i = 0; i < differences; ++i) {
        const unsigned own = Side::kReading ? 0 : node.differences[p * differences + i];
        const unsigned coded = differences_.code(side_, own);
        if constexpr (Side::kReading) node.differences.push_back(static_cast<std::uint8_t>(coded));
      }
      check();
    }
  }

  Side& side_;
  std::size_t bytes_;
  Numbers bases_, centres_, counts_, terms_, firsts_;
  Usual first_{16 * 64};
  BitTree<8> differences_;
};

void make_cosines(Plan& plan) {
  plan.cosines.assign(kMostFrames + 1, Cosines(0));
  plan.cosines[kMostFrames] = Cosines(kMostFrames);
  for (const Node& node : plan.nodes) {
    Cosines& own = plan.cosines[node.frames];
    if (own.frames() == 0) own = Cosines(node.frames);
  }
}

void read_database(Plan& plan, Record& record) {
  const ByteView coded = record.bytes();
  RangeReading side(coded);
  Database database(side, coded.size());
  for (Node& node : plan.nodes) database.code(node, plan.published);
  if (!side.exhausted()) fail("a database that does not end where it should");
  make_cosines(plan);
}

void read_body(Plan& plan, Record& record, std::size_t columns) {
  read_columns(plan, record, columns);
  read_nodes(plan, record);
}

}  // namespace

Plan read_plan(ByteView header, ByteView model, std::size_t columns) {
  Plan plan;
  Record record(header);
  const bool learned = record.integer(1) != 0;
  record.number();  // the ARMS that was found
  plan.place = positive(record);
  plan.track = positive(record);
  plan.protected_track = positive(record);
  plan.correction = record.number();
  plan.protected_correction = record.number();
  if (!(plan.correction >= 0 && plan.correction <= 1e12) ||
      !(plan.protected_correction >= 0 && plan.protected_correction <= 1e12)) {
    fail("steps that are no numbers");
  }
  plan.smoothed = record.integer(8);
  if (!learned) {
    read_body(plan, record, columns);
    read_database(plan, record);
  } else {
    if (model.empty()) fail("the clip was coded with a model");
    Record own(model);
    own.bytes();  // what it is for
    read_body(plan, own, columns);
    read_database(plan, own);
    own.end();
  }
  record.end();
  return plan;
}

Plan read_body_alone(ByteView body, std::size_t columns) {
  Plan plan;
  Record record(body);
  read_body(plan, record, columns);
  record.end();
  make_cosines(plan);
  return plan;
}

Bytes write_database(const Plan& plan) {
  RangeWriting side;
  Database database(side, std::size_t{1} << 28);
  for (Node node : plan.nodes) database.code(node, plan.published);
  return side.finish();
}

void shape_of(const Plan& plan, std::size_t index, std::size_t pattern, double* shape) {
  const Node& node = plan.nodes[index];
  const std::size_t count = node.components;
  if (plan.published) {
    const double least = node.quantisers[2 * pattern], step = node.quantisers[2 * pattern + 1];
    const std::uint8_t* next = node.differences.data() + pattern * (node.frames - 1) * count;
    for (std::size_t j = 0; j < count; ++j) {
      const auto first = static_cast<double>(node.first[pattern * count + j]);
      shape[j] = first * (plan.pattern / node.importance);
    }
    for (std::size_t i = count; i < node.frames * count; ++i) {
      const double more = least + step * static_cast<double>(*next++);
      shape[i] = shape[i - count] + more;
    }
    return;
  }
  const double step =
      (plan.pattern / node.importance) * std::sqrt(static_cast<double>(node.frames));
  std::fill(shape, shape + node.frames * count, 0.0);
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t series = pattern * count + j;
    for (std::size_t i = node.starts[series]; i < node.starts[series + 1]; ++i) {
      if (node.terms[i] == 0) continue;
      const double size = static_cast<double>(node.terms[i]) * step;
      const double* const cosine = plan.cosines[node.frames].of(i - node.starts[series]);
      for (std::size_t r = 0; r < node.frames; ++r) shape[r * count + j] += size * cosine[r];
    }
  }
}

}  // namespace mocapress::patterns
