// A clip that is played: chunks that were decoded, and poses of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "coding/bit.hpp"
#include "motion/kinematics.hpp"
#include "player/head.hpp"
#include "player/sections.hpp"

namespace mocapress::player {

class Clip {
 public:
  // Takes the contents of a file. `fail`s where it is damaged, throws Unsupported where it has no
  // motion that is known here.
  explicit Clip(Bytes file);

  Clip(const Clip&) = delete;
  Clip& operator=(const Clip&) = delete;
  Clip(Clip&&) = delete;
  Clip& operator=(Clip&&) = delete;
  ~Clip() = default;

  std::uint64_t frames() const { return frames_; }
  const Stream& stream() const { return head_.streams.front(); }
  const Skeleton& skeleton() const { return head_.skeleton; }
  const Rig* rig() const { return rig_.get(); }

  // Decodes what poses at a place need: a frame and a part of the way to the next.
  void seek(double frame);

  // Fills 3 numbers for each point, 4 for each joint; either may be null. There is a rig.
  void pose(double frame, bool locally, double* places, double* turns);

  // Fills the values of a frame that is there.
  void values(std::uint64_t frame, double* row);

 private:
  // Chunks of the stream, decoded; what stands in it is good where `chunk` is one.
  struct Block {
    std::size_t chunk = SIZE_MAX;
    std::uint64_t first = 0, frames = 0;
    std::vector<double> values;
    std::vector<double> places, turns;  // relative to the parents
    bool has(std::uint64_t frame) const {
      return chunk != SIZE_MAX && frame >= first && frame - first < frames;
    }
  };
  struct Between {
    std::uint64_t before, behind;
    double part;
  };

  void check_chunks();
  Between between(double frame) const;
  const Block& block_of(std::uint64_t frame);
  void load(Block& block, std::size_t chunk);

  Bytes file_;
  Head head_;
  std::vector<Chunk> chunks_;  // of the stream, in the order of frames
  std::uint64_t frames_ = 0;
  std::unique_ptr<const Rig> rig_;
  std::vector<Vector> ends_;
  std::array<Block, 2> blocks_;
  std::size_t latest_ = 0;  // of the blocks
  std::vector<double> places_, turns_;
};

}  // namespace mocapress::player
