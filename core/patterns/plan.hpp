// What all chunks of a clip share: which columns move together, and the patterns of each group.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coding/bit.hpp"
#include "patterns/curves.hpp"

namespace mocapress::patterns {

inline constexpr std::size_t kMostFrames = 64;      // of a pattern, and of a block of a track
inline constexpr std::size_t kMostComponents = 32;  // of a node with a basis
inline constexpr double kBasisSteps = 512;

// A group of columns that is cut into segments, each of which follows a pattern.
struct Node {
  std::vector<std::size_t> columns;
  std::size_t frames = 1;      // of a pattern
  std::size_t patterns = 1;    // how many
  std::size_t components = 0;  // that a pattern moves
  double importance = 1;
  std::vector<std::int64_t> basis;   // (components, columns), in 1/kBasisSteps
  std::vector<std::int64_t> centre;  // of each column, in steps of places
  // Of patterns as cosines, (patterns, components): where the terms of each begin.
  std::vector<std::uint32_t> starts;
  std::vector<std::int64_t> terms;
  // Of published patterns: first frames, (patterns, components), differences from the frame before,
  // (patterns, frames - 1, components), and how large these are: least and step of each pattern.
  std::vector<std::int64_t> first;
  std::vector<std::uint8_t> differences;
  std::vector<float> quantisers;
};

enum class Role : std::uint8_t { track, protected_track, copy, node };

struct Plan {
  double place = 1, track = 1, protected_track = 1;  // steps
  double correction = 0, protected_correction = 0;   // steps; 0: there are none
  std::size_t smoothed = 0;                          // frames on either side of a boundary
  bool apart = true, published = false;
  double pattern = 1;  // step
  std::vector<Role> roles;
  std::vector<std::size_t> references;  // kNone: none
  std::vector<Node> nodes;
  std::vector<Cosines> cosines;  // by the number of frames; those that nodes and tracks have

  static constexpr std::size_t kNone = ~std::size_t{0};
};

// `model` is empty where there is none. `fail`s where one is no such header or model, or not of so
// many columns.
Plan read_plan(ByteView header, ByteView model, std::size_t columns);

// Reads a body that ends before its database; and gives the database of nodes that are complete.
Plan read_body_alone(ByteView body, std::size_t columns);
Bytes write_database(const Plan& plan);

// Fills the frames of a pattern, (node.frames, node.components).
void shape_of(const Plan& plan, std::size_t node, std::size_t pattern, double* shape);

}  // namespace mocapress::patterns
