// libmocapress on any file. Checksums count as right here, so that what lies behind them is
// reached.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "mocapress.h"

namespace {

constexpr std::size_t kLargest = std::size_t{1} << 20;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mocapress_clip* clip = nullptr;
  if (mocapress_open(data, size, &clip) != MOCAPRESS_OK) {
    if (clip != nullptr || mocapress_message()[0] == '\0') std::abort();
    return 0;
  }
  const std::size_t frames = mocapress_frames(clip), points = mocapress_points(clip),
                    joints = mocapress_joints(clip);
  for (std::size_t p = 0; p < points; ++p) {
    if (mocapress_parent(clip, p) >= static_cast<std::ptrdiff_t>(joints)) std::abort();
    static_cast<void>(mocapress_joint_name(clip, p));
  }
  mocapress_set_rate(clip, 1);
  std::vector<double> row(mocapress_channels(clip)), places(3 * points), turns(4 * joints);
  for (const double part : {0.0, 0.3, 0.5, 0.999, 2.0}) {
    if (frames == 0 || frames * (row.size() + points) > kLargest) break;
    const double at = part * static_cast<double>(frames);
    const auto frame = static_cast<std::size_t>(at) % frames;
    if (mocapress_values(clip, frame, row.data()) == MOCAPRESS_BAD_ARGUMENT) std::abort();
    for (const auto space : {MOCAPRESS_WORLD, MOCAPRESS_LOCAL}) {
      if (mocapress_pose(clip, at, space, places.data(), turns.data()) == MOCAPRESS_BAD_ARGUMENT) {
        std::abort();
      }
    }
  }
  mocapress_close(clip);
  return 0;
}
