// The constants of `exact`. They are data of the file format: docs/format/exact.md lists the files
// in data/, their layouts and their digests.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace mocapress::exact {

// A branch of the y law: polynomials of degree 4 in three bends.
struct Branch {
  std::array<double, 35> near;  // g
  std::array<double, 35> root;  // h
};

// The laws of a chain of three joints.
template <std::size_t kBranches>
struct ChainTables {
  std::array<Branch, kBranches> branches;
  std::array<double, 22> twist;   // of the last joint
  std::array<double, 12> middle;  // the twist of the joint before it
};

inline constexpr std::size_t kBones = 29;
inline constexpr std::size_t kSkeletonChannels = 62;

struct SkeletonBone {
  int parent;
  std::array<double, 3> axis;   // degrees about x, y, z
  std::array<double, 3> start;  // in the parent's frame
  std::array<double, 3> end;    // in the bone's frame
  std::array<int, 6> channels;  // of tx, ty, tz, rx, ry, rz: place among all channels, or -1
  double mass, inertia;         // at the end
};

struct SkeletonChannel {
  int bone;
  int limb;
  double resistance;
};

struct SkeletonTables {
  std::array<SkeletonBone, kBones> bones;
  std::array<SkeletonChannel, kSkeletonChannels> channels;
};

// Chances in 1/65536, by the node of a tree of six bits.
struct FirstChances {
  std::array<std::uint16_t, 64> shape;          // that a bit of a bucket is 1
  std::array<std::uint16_t, 64> noise_kinds;    // that a bit of the kind of a noise is 0
  std::array<std::uint16_t, 64> noise_lengths;  // that a bit of its length is 0
};

inline constexpr std::size_t kHidden = 64;
inline constexpr std::size_t kNetworkInputs = 48;  // the last two are 0
inline constexpr std::size_t kOutputs = 2;

// Whole numbers, 1/1024; of each row of weights the sum is one unit.
struct NetworkTable {
  template <std::size_t kCount>
  using Row = std::array<std::int16_t, kCount>;

  std::array<Row<kNetworkInputs>, kHidden> first;
  Row<kHidden> first_biases;
  std::array<Row<kHidden>, kHidden> second;
  Row<kHidden> second_biases;
  std::array<Row<kHidden>, kOutputs> last;
  Row<kNetworkInputs> direct;
  Row<kOutputs> biases;
};

// The files are the numbers alone, without inner braces.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-braces"

inline constexpr ChainTables<4> kSpine = {
#include "data/spine_1.txt"
};

inline constexpr ChainTables<7> kNeck = {
#include "data/neck_1.txt"
};

inline constexpr SkeletonTables kCmu = {
#include "data/skeleton_cmu_1.txt"
};

inline constexpr FirstChances kFirst = {
#include "data/start_1.txt"
};

inline constexpr NetworkTable kNetwork = {
#include "data/network_2.txt"
};

#pragma GCC diagnostic pop

}  // namespace mocapress::exact
