// The codec `patterns`: groups of columns as segments that follow patterns, beside tracks that are
// coded as they are (docs/format/patterns.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coding/bit.hpp"
#include "patterns/plan.hpp"

namespace mocapress::patterns {

// Fills frames x columns values.
void decode(ByteView payload, double* values, std::size_t frames, const Plan& plan);

// What a chunk is made of: the root and protected columns; of segments how long they are, their
// patterns and their places; corrections.
enum class Part : std::uint8_t { tracks, lengths, indices, places, corrections };
inline constexpr std::size_t kParts = 5;

// The bits that each part of a chunk takes.
std::array<double, kParts> bits_of(ByteView payload, std::size_t frames, const Plan& plan);

// How the frames of a chunk are cut for a node, and what pattern each segment follows.
struct Segments {
  std::vector<std::size_t> frames;
  std::vector<std::size_t> patterns;
};

// What is coded: frames x columns each, and for each node.
struct Given {
  const double* original;
  const double* filled;      // the same, finite everywhere
  const std::uint8_t* kept;  // 1: comes back as it is
  std::span<const Segments> segments;
  std::span<const double> projections;  // (components, columns) of each node, one behind the other
  double max_error, protected_error;
};

Bytes encode(const Given& given, std::size_t frames, const Plan& plan);

}  // namespace mocapress::patterns
