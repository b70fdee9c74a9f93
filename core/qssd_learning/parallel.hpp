// All processors on slices of one range.
#pragma once

#include <algorithm>
#include <cstddef>
#ifndef __wasm__
#include <thread>
#endif
#include <vector>

namespace mocapress::qssd {

// Calls work(first, last) for slices of [0, count); none of fewer than `least`.
template <class Work>
void in_parallel(std::size_t count, std::size_t least, const Work& work) {
#ifdef __wasm__
  static_cast<void>(least);  // no threads there
  work(0, count);
#else
  const std::size_t most = std::max<std::size_t>(std::thread::hardware_concurrency(), 1);
  const std::size_t slices =
      std::clamp<std::size_t>(count / std::max<std::size_t>(least, 1), 1, most);
  std::vector<std::thread> others;
  for (std::size_t s = 1; s < slices; ++s) {
    others.emplace_back(work, count * s / slices, count * (s + 1) / slices);
  }
  work(0, count / slices);
  for (auto& other : others) other.join();
#endif
}

}  // namespace mocapress::qssd
