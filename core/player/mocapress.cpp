// include/mocapress.h: what C sees of a clip.
#include "mocapress.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "player/clip.hpp"
#include "player/error.hpp"

using mocapress::Bytes;
using mocapress::player::Clip;
using mocapress::player::Unsupported;

struct mocapress_clip {  // NOLINT(readability-identifier-naming)
  explicit mocapress_clip(Bytes file) : clip(std::move(file)) {
    frame_time = clip.stream().frame_time;
  }

  Clip clip;
  double frame_time;
};

namespace {

constexpr std::size_t kLongestMessage = 256;
constexpr double kCentimetresPerInch = 2.54;

// Of no allocation, so that one that fails can be told, too.
thread_local char message[kLongestMessage];  // NOLINT(*-identifier-naming)

mocapress_status told(mocapress_status status, const char* what) {
  std::snprintf(message, sizeof message, "%s", what);
  return status;
}

template <class Work>
mocapress_status done(Work work) {
  try {
    return work();
  } catch (const Unsupported& error) {
    return told(MOCAPRESS_UNSUPPORTED, error.what());
  } catch (const std::invalid_argument& error) {
    return told(MOCAPRESS_CORRUPT, error.what());
  } catch (const std::bad_alloc&) {
    return told(MOCAPRESS_NO_MEMORY, "not enough memory");
  } catch (const std::exception& error) {
    return told(MOCAPRESS_CORRUPT, error.what());
  }
}

Bytes contents(std::FILE* file) {
  Bytes read;
  std::size_t size = 0;
  do {
    read.resize(size + (std::size_t{1} << 16) + size / 2);
    size += std::fread(read.data() + size, 1, read.size() - size, file);
  } while (size == read.size());
  read.resize(size);
  return read;
}

mocapress_status at_time(mocapress_clip* clip, double seconds, double& frame) {
  if (clip == nullptr) return told(MOCAPRESS_BAD_ARGUMENT, "no clip");
  if (!std::isfinite(seconds)) return told(MOCAPRESS_BAD_ARGUMENT, "a time that is no number");
  if (clip->clip.frames() == 0) return told(MOCAPRESS_BAD_ARGUMENT, "a clip without frames");
  if (!(clip->frame_time > 0)) {
    return told(MOCAPRESS_NO_RATE, "the file does not state its sampling rate");
  }
  frame = seconds / clip->frame_time;
  return MOCAPRESS_OK;
}

}  // namespace

const char* mocapress_message() { return message; }

mocapress_status mocapress_open_file(const char* path, mocapress_clip** clip) {
  if (path == nullptr || clip == nullptr) return told(MOCAPRESS_BAD_ARGUMENT, "a null pointer");
  *clip = nullptr;
  return done([&] {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path, "rb"), std::fclose);
    if (!file) return told(MOCAPRESS_CANNOT_READ, "the file cannot be opened");
    Bytes data = contents(file.get());
    if (std::ferror(file.get()) != 0) {
      return told(MOCAPRESS_CANNOT_READ, "the file cannot be read");
    }
    *clip = new mocapress_clip(std::move(data));
    return MOCAPRESS_OK;
  });
}

mocapress_status mocapress_open(const void* data, size_t size, mocapress_clip** clip) {
  if (clip == nullptr || (data == nullptr && size > 0)) {
    return told(MOCAPRESS_BAD_ARGUMENT, "a null pointer");
  }
  *clip = nullptr;
  return done([&] {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    *clip = new mocapress_clip(Bytes(bytes, bytes + size));
    return MOCAPRESS_OK;
  });
}

void mocapress_close(mocapress_clip* clip) { delete clip; }

size_t mocapress_frames(const mocapress_clip* clip) {
  return clip == nullptr ? 0 : clip->clip.frames();
}

size_t mocapress_channels(const mocapress_clip* clip) {
  return clip == nullptr ? 0 : clip->clip.stream().columns.size();
}

size_t mocapress_joints(const mocapress_clip* clip) {
  return clip == nullptr || clip->clip.rig() == nullptr ? 0 : clip->clip.rig()->joints();
}

size_t mocapress_points(const mocapress_clip* clip) {
  return clip == nullptr || clip->clip.rig() == nullptr ? 0 : clip->clip.rig()->points();
}

const char* mocapress_joint_name(const mocapress_clip* clip, size_t joint) {
  return joint < mocapress_joints(clip) ? clip->clip.skeleton().joints[joint].name.c_str() : "";
}

ptrdiff_t mocapress_parent(const mocapress_clip* clip, size_t point) {
  return point < mocapress_points(clip) ? clip->clip.rig()->parent(point) : -1;
}

double mocapress_unit(const mocapress_clip* clip) {
  if (clip == nullptr) return 0;
  // ASF files say 1 where they mean nothing by it.
  const double unit = clip->clip.skeleton().length_unit.value_or(1);
  return unit > 0 && unit != 1 ? kCentimetresPerInch / unit : 0;
}

double mocapress_frame_time(const mocapress_clip* clip) {
  return clip == nullptr ? 0 : clip->frame_time;
}

mocapress_status mocapress_set_rate(mocapress_clip* clip, double rate) {
  if (clip == nullptr || !(rate > 0) || !(1 / rate > 0)) {
    return told(MOCAPRESS_BAD_ARGUMENT, "a rate is above 0");
  }
  clip->frame_time = 1 / rate;
  return MOCAPRESS_OK;
}

mocapress_status mocapress_seek(mocapress_clip* clip, double seconds) {
  double frame = 0;
  const mocapress_status status = at_time(clip, seconds, frame);
  if (status != MOCAPRESS_OK) return status;
  return done([&] {
    clip->clip.seek(frame);
    return MOCAPRESS_OK;
  });
}

mocapress_status mocapress_pose(mocapress_clip* clip, double seconds, mocapress_space space,
                                double* positions, double* rotations) {
  double frame = 0;
  const mocapress_status status = at_time(clip, seconds, frame);
  if (status != MOCAPRESS_OK) return status;
  if (space != MOCAPRESS_WORLD && space != MOCAPRESS_LOCAL) {
    return told(MOCAPRESS_BAD_ARGUMENT, "no such space");
  }
  if (clip->clip.rig() == nullptr) return told(MOCAPRESS_UNSUPPORTED, "a clip without a skeleton");
  return done([&] {
    clip->clip.pose(frame, space == MOCAPRESS_LOCAL, positions, rotations);
    return MOCAPRESS_OK;
  });
}

mocapress_status mocapress_values(mocapress_clip* clip, size_t frame, double* values) {
  if (clip == nullptr || values == nullptr) return told(MOCAPRESS_BAD_ARGUMENT, "a null pointer");
  if (frame >= clip->clip.frames()) return told(MOCAPRESS_BAD_ARGUMENT, "no such frame");
  return done([&] {
    clip->clip.values(frame, values);
    return MOCAPRESS_OK;
  });
}
