#include "player/clip.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coding/fail.hpp"
#include "coding/record.hpp"
#include "player/decoding.hpp"
#include "player/error.hpp"
#include "player/packing.hpp"

namespace mocapress::player {
namespace {

constexpr std::size_t kMostHead = 1 << 24;

// What is allocated is bounded by the file, not by what it announces.
std::uint64_t most_values(std::size_t file) { return (1 << 22) + (std::uint64_t{1} << 12) * file; }
std::uint64_t most_joints(std::size_t file) { return (1 << 20) + (std::uint64_t{1} << 12) * file; }

void multiply(const double* a, const double* b, double* product) {
  product[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
  product[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
  product[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
  product[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

// A place in a frame that is turned and lies elsewhere.
void put(const double* turn, const double* place, const double* origin, double* put) {
  const double x = 2 * (turn[2] * place[2] - turn[3] * place[1]),
               y = 2 * (turn[3] * place[0] - turn[1] * place[2]),
               z = 2 * (turn[1] * place[1] - turn[2] * place[0]);
  const double moved[3] = {place[0] + turn[0] * x + turn[2] * z - turn[3] * y,
                           place[1] + turn[0] * y + turn[3] * x - turn[1] * z,
                           place[2] + turn[0] * z + turn[1] * y - turn[2] * x};
  for (int i = 0; i < 3; ++i) put[i] = origin[i] + moved[i];
}

// At constant speed, the shorter way.
void turn_between(const double* a, const double* b, double part, double* turn) {
  // Within this cosine of half an angle, unequal speeds are off by less than 1e-7 radians.
  constexpr double kNear = 0.9999;
  const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const double cosine = std::fabs(dot);
  double of_a = 1 - part, of_b = part;
  if (cosine < kNear) {
    const double angle = std::acos(cosine), sine = std::sin(angle);
    of_a = std::sin(of_a * angle) / sine;
    of_b = std::sin(of_b * angle) / sine;
  }
  if (dot < 0) of_b = -of_b;
  double square = 0;
  for (int i = 0; i < 4; ++i) {
    turn[i] = of_a * a[i] + of_b * b[i];
    square += turn[i] * turn[i];
  }
  const double scale = 1 / std::sqrt(square);
  for (int i = 0; i < 4; ++i) turn[i] *= scale;
}

}  // namespace

Clip::Clip(Bytes file) : file_(std::move(file)) {
  Sections sections = read_sections(file_);
  head_ = read_head(unpack(Record(sections.head), kMostHead));
  const auto& streams = head_.streams;
  const bool recording =
      !sections.has_original &&
      std::all_of(streams.begin(), streams.end(), [](const Stream& each) { return !each.frames; });
  if (!sections.closed && !recording) fail("the file is cut off");
  chunks_ = std::move(sections.chunks);
  check_chunks();
  if (stream().kind != "channels") throw Unsupported("a stream of another kind than channels");
  check_codec(stream());
  std::erase_if(chunks_, [](const Chunk& chunk) { return chunk.stream != 0; });
  if (skeleton().joints.empty()) return;
  rig_ = std::make_unique<Rig>(skeleton(), stream().columns, stream().radians);
  for (const auto& joint : skeleton().joints) {
    ends_.insert(ends_.end(), joint.ends.begin(), joint.ends.end());
  }
  places_.resize(rig_->points() * 3);
  turns_.resize(rig_->joints() * 4);
}

void Clip::check_chunks() {
  const auto& streams = head_.streams;
  std::vector<std::uint64_t> reached(streams.size());
  std::uint64_t values = 0;
  for (const auto& chunk : chunks_) {
    if (chunk.stream >= streams.size()) fail("a chunk of no stream");
    auto& next = reached[chunk.stream];
    if (chunk.first != next) fail("chunks in the wrong order");
    next += chunk.frames;
    const std::uint64_t columns = std::max<std::size_t>(streams[chunk.stream].columns.size(), 1);
    values += chunk.frames * columns;  // below 2^58 each
    if (values > most_values(file_.size())) fail("more numbers announced than a file may");
    if (chunk.frames * skeleton().joints.size() > most_joints(file_.size())) {
      fail("more joints announced than a file may");
    }
  }
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const auto& announced = streams[i].frames;
    if (announced && *announced != reached[i]) fail("frames are missing");
  }
  frames_ = reached[0];
}

Clip::Between Clip::between(double frame) const {
  const auto last = static_cast<double>(frames_ - 1);
  const double inside = std::clamp(frame, 0.0, last);
  const auto before = static_cast<std::uint64_t>(inside);
  return {before, std::min(before + 1, frames_ - 1), inside - static_cast<double>(before)};
}

void Clip::seek(double frame) {
  const Between at = between(frame);
  block_of(at.before);
  if (at.part > 0) block_of(at.behind);
}

const Clip::Block& Clip::block_of(std::uint64_t frame) {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].has(frame)) {
      latest_ = i;
      return blocks_[i];
    }
  }
  const auto behind = std::upper_bound(
      chunks_.begin(), chunks_.end(), frame,
      [](std::uint64_t wanted, const Chunk& chunk) { return wanted < chunk.first; });
  latest_ = 1 - latest_;
  load(blocks_[latest_], static_cast<std::size_t>(behind - chunks_.begin()) - 1);
  return blocks_[latest_];
}

void Clip::load(Block& block, std::size_t index) {
  const Chunk& chunk = chunks_[index];
  const std::size_t columns = stream().columns.size(), frames = chunk.frames;
  block.chunk = SIZE_MAX;
  block.values.resize(frames * columns);
  decode(stream(), chunk, block.values.data());
  if (rig_) {
    const std::size_t joints = rig_->joints();
    block.places.resize(frames * joints * 3);
    block.turns.resize(frames * joints * 4);
    for (std::size_t f = 0; f < frames; ++f) {
      const double* row = block.values.data() + f * columns;
      if (rig_->stretches(row)) throw Unsupported("bones that stretch have no kinematics here");
      rig_->place_locally(row, block.places.data() + f * joints * 3,
                          block.turns.data() + f * joints * 4);
    }
  }
  block.first = chunk.first;
  block.frames = chunk.frames;
  block.chunk = index;
}

void Clip::pose(double frame, bool locally, double* places, double* turns) {
  const std::size_t joints = rig_->joints();
  const Between at = between(frame);
  const Block& first = block_of(at.before);
  const Block& second = at.part > 0 ? block_of(at.behind) : first;
  const std::size_t a = at.before - first.first;
  const std::size_t b = at.part > 0 ? at.behind - second.first : a;
  const double *place_a = first.places.data() + a * joints * 3,
               *place_b = second.places.data() + b * joints * 3,
               *turn_a = first.turns.data() + a * joints * 4,
               *turn_b = second.turns.data() + b * joints * 4;
  for (std::size_t j = 0; j < joints; ++j) {
    const std::int32_t parent = locally ? -1 : rig_->parent(j);
    double turn[4], place[3];
    if (at.part > 0) {
      turn_between(turn_a + 4 * j, turn_b + 4 * j, at.part, turn);
    } else {
      std::copy_n(turn_a + 4 * j, 4, turn);
    }
    for (int i = 0; i < 3; ++i) {
      const double from = place_a[3 * j + i];
      place[i] = from + (place_b[3 * j + i] - from) * at.part;
    }
    if (parent < 0) {
      std::copy_n(turn, 4, turns_.data() + 4 * j);
      std::copy_n(place, 3, places_.data() + 3 * j);
      continue;
    }
    const auto above = static_cast<std::size_t>(parent);
    multiply(turns_.data() + 4 * above, turn, turns_.data() + 4 * j);
    put(turns_.data() + 4 * above, place, places_.data() + 3 * above, places_.data() + 3 * j);
  }
  for (std::size_t p = joints; p < rig_->points(); ++p) {
    const auto above = static_cast<std::size_t>(rig_->parent(p));
    const Vector& end = ends_[p - joints];
    if (locally) {
      std::copy_n(end.data(), 3, places_.data() + 3 * p);
    } else {
      put(turns_.data() + 4 * above, end.data(), places_.data() + 3 * above,
          places_.data() + 3 * p);
    }
  }
  if (places != nullptr) std::copy(places_.begin(), places_.end(), places);
  if (turns != nullptr) std::copy(turns_.begin(), turns_.end(), turns);
}

void Clip::values(std::uint64_t frame, double* row) {
  const Block& block = block_of(frame);
  const std::size_t columns = stream().columns.size();
  std::copy_n(block.values.data() + (frame - block.first) * columns, columns, row);
}

}  // namespace mocapress::player
