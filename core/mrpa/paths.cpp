#include "mrpa/paths.hpp"

#include <algorithm>
#include <tuple>

#include "coding/fail.hpp"

namespace mocapress::mrpa {
namespace {

constexpr std::int32_t kLongestLink = 2;  // a link leads from match i to one of [i, i + 2]
constexpr std::int64_t kNone = -1;

// The best path that ends at a node.
struct Node {
  std::int64_t before;  // the node that it came from
  std::int32_t first;   // frame of the top row at which it begins
  std::int32_t root;    // and the match there
  double distance;
  bool leaf;
};

void check(const Trellis& trellis) {
  const auto frames = static_cast<std::int64_t>(trellis.clips.size());
  const auto nodes = static_cast<std::int64_t>(trellis.matches.size());
  if (trellis.starts.size() != trellis.clips.size() + 1 || trellis.starts[0] != 0 ||
      trellis.starts.back() != nodes || trellis.distances.size() != trellis.matches.size()) {
    fail("the parts of the trellis do not fit");
  }
  for (std::int64_t t = 0; t < frames; ++t) {
    if (trellis.starts[t] > trellis.starts[t + 1]) fail("columns that do not follow each other");
    for (std::int64_t n = trellis.starts[t]; n < trellis.starts[t + 1]; ++n) {
      const std::int32_t match = trellis.matches[n];
      const bool ascending = n == trellis.starts[t] || trellis.matches[n - 1] < match;
      if (match < 0 || match >= frames || !ascending) fail("matches that are no ascending frames");
    }
  }
}

std::int32_t depth_of(const Node& node, std::int32_t frame) { return frame - node.first + 1; }

// Whether the segments on both sides stay apart: h_i2 < v_i1 or v_i2 < h_i1.
bool apart(const Node& before, std::int32_t frame, std::int32_t match) {
  return frame < before.root || match < before.first;
}

// Extends the paths of the column before to one node; leaves them where none can be.
Node extended(const Trellis& trellis, std::vector<Node>& nodes, std::int32_t frame,
              std::int64_t node, std::int64_t from, std::int64_t to) {
  const std::int32_t match = trellis.matches[node];
  const double distance = trellis.distances[node];
  Node found{kNone, frame, match, distance, true};
  for (std::int64_t n = from; n < to; ++n) {
    const Node& before = nodes[n];
    if (trellis.clips[trellis.matches[n]] != trellis.clips[match]) continue;
    if (!apart(before, frame, match)) continue;
    const double sum = before.distance + distance;
    if (found.before == kNone || before.first < found.first ||
        (before.first == found.first && sum < found.distance)) {
      found = {n, before.first, before.root, sum, true};
    }
  }
  if (found.before != kNone) nodes[found.before].leaf = false;
  return found;
}

std::vector<Node> grown(const Trellis& trellis) {
  std::vector<Node> nodes;
  nodes.reserve(trellis.matches.size());
  const auto frames = static_cast<std::int32_t>(trellis.clips.size());
  for (std::int32_t t = 0; t < frames; ++t) {
    const bool follows = t > 0 && trellis.clips[t] == trellis.clips[t - 1];
    std::int64_t from = follows ? trellis.starts[t - 1] : trellis.starts[t];
    std::int64_t to = from;
    const std::int64_t end = trellis.starts[t];
    for (std::int64_t n = trellis.starts[t]; n < trellis.starts[t + 1]; ++n) {
      const std::int32_t match = trellis.matches[n];
      while (from < end && trellis.matches[from] < match - kLongestLink) ++from;
      to = std::max(to, from);
      while (to < end && trellis.matches[to] <= match) ++to;
      nodes.push_back(extended(trellis, nodes, t, n, from, to));
    }
  }
  return nodes;
}

struct Leaf {
  std::int32_t first;
  std::int32_t root;
  std::int32_t depth;
  double distance;
  std::int64_t node;
};

bool better(const Leaf& one, const Leaf& other, Keep keep) {
  // Averages compared without dividing.
  const double own = one.distance * other.depth;
  const double others = other.distance * one.depth;
  if (keep == Keep::deepest) {
    return one.depth != other.depth ? one.depth > other.depth : own < others;
  }
  return own != others ? own < others : one.depth > other.depth;
}

}  // namespace

Paths grow(const Trellis& trellis, std::int32_t least_depth, Keep keep) {
  check(trellis);
  const std::vector<Node> nodes = grown(trellis);
  std::vector<Leaf> leaves;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(trellis.clips.size()); ++t) {
    for (std::int64_t n = trellis.starts[t]; n < trellis.starts[t + 1]; ++n) {
      const Node& node = nodes[n];
      if (!node.leaf || depth_of(node, t) < least_depth) continue;
      leaves.push_back({node.first, node.root, depth_of(node, t), node.distance, n});
    }
  }
  std::sort(leaves.begin(), leaves.end(), [&](const Leaf& a, const Leaf& b) {
    if (std::tie(a.first, a.root) != std::tie(b.first, b.root)) {
      return std::tie(a.first, a.root) < std::tie(b.first, b.root);
    }
    if (better(a, b, keep) || better(b, a, keep)) return better(a, b, keep);
    return a.node < b.node;
  });
  Paths paths;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const Leaf& leaf = leaves[i];
    if (i > 0 && leaves[i - 1].first == leaf.first && leaves[i - 1].root == leaf.root) continue;
    const std::size_t begin = paths.vertical.size();
    paths.vertical.resize(begin + static_cast<std::size_t>(leaf.depth));
    std::int64_t node = leaf.node;
    for (std::size_t at = paths.vertical.size(); at > begin; node = nodes[node].before) {
      paths.vertical[--at] = trellis.matches[node];
    }
    paths.first.push_back(leaf.first);
    paths.distance.push_back(leaf.distance);
    paths.begin.push_back(static_cast<std::int64_t>(paths.vertical.size()));
  }
  return paths;
}

}  // namespace mocapress::mrpa
