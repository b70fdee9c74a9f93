// The codec `qssd`: frames as predictions from others, turned by products of a dictionary's atoms
// (docs/format/qssd.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coding/bit.hpp"
#include "qssd/body.hpp"
#include "qssd/pyramid.hpp"
#include "qssd/symbols.hpp"

namespace mocapress::qssd {

// An atom's part in a joint.
struct Part {
  std::array<double, 3> axis{};
  double half_angle = 0;
};

// What all chunks of a clip share.
struct Plan {
  Body body;
  std::size_t atoms = 0;
  std::vector<Part> parts;            // (atoms, joints)
  std::vector<std::uint8_t> chances;  // core/qssd/symbols.hpp
  int levels = 0;
  int omitted = 0;   // of the levels, the finest
  double step = 1;   // of weights
  double patch = 0;  // of corrections; 0: there are none
};

// `model` is empty where there is none. `fail`s where one is no such header or model, or not of so
// many columns.
Plan read_plan(ByteView header, ByteView model, std::size_t columns);

// Fills frames x columns values.
void decode(ByteView payload, double* values, std::size_t frames, const Plan& plan);

// Codes what `symbols`, (samples, atoms + columns) in the order of the stages, say, and what is to
// be done to values that differ too much then: see Patches.
struct Patches {
  std::vector<std::uint8_t> kinds;        // (columns, frames): 0 none, 1 corrected, 2 as they are
  std::vector<std::int64_t> corrections;  // (columns, frames), or the bits
};
Bytes encode(std::span<const std::int64_t> symbols, std::size_t frames, const Plan& plan,
             const Patches& patches);

// What a frame's symbols make of its predictions.
void put_together(const Sample& sample, const std::int64_t* symbols, const Plan& plan, Pose& pose);
// The rows of columns that frames are.
void write_rows(const Pose& pose, std::size_t frames, const Plan& plan, double* values);

}  // namespace mocapress::qssd
