#include "mrpa/segments.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "coding/fail.hpp"

namespace mocapress::mrpa {
namespace {

// The output layer: segments one behind the other.
class Layer {
 public:
  Layer(std::int64_t frames, std::int64_t length, std::int64_t least)
      : frames_(frames), least_(least) {
    const std::int64_t count = (frames + length - 1) / length;  // Eq. 4
    for (std::int64_t j = 0; j < count; ++j) firsts_.push_back(j * frames / count);
  }

  void learn(const Segment& input, double rate) {
    const std::size_t j = most_alike(input);
    const auto moved = [&](std::int64_t from, std::int64_t to) -> std::int64_t {
      return from + std::llround(rate * static_cast<double>(to - from));  // Eq. 7
    };
    const std::int64_t first = moved(firsts_[j], input.first);
    const std::int64_t last = std::max(first, moved(last_of(j), input.second));
    move_last(j, last);  // before the start, which may change the index
    move_first(j, first);
  }

  std::vector<Segment> segments() const {
    std::vector<Segment> all;
    all.reserve(firsts_.size());
    for (std::size_t j = 0; j < firsts_.size(); ++j) all.emplace_back(firsts_[j], last_of(j));
    return all;
  }

 private:
  std::int64_t last_of(std::size_t j) const {
    return (j + 1 < firsts_.size() ? firsts_[j + 1] : frames_) - 1;
  }

  // Index of the segment of the largest IoU (Eq. 6), of two the earlier.
  std::size_t most_alike(const Segment& input) const {
    auto next = std::upper_bound(firsts_.begin(), firsts_.end(), input.first);
    std::size_t best = static_cast<std::size_t>(next - firsts_.begin()) - 1;
    double most = -1;
    for (std::size_t j = best; j < firsts_.size() && firsts_[j] <= input.second; ++j) {
      const std::int64_t overlap =
          std::min(input.second, last_of(j)) - std::max(input.first, firsts_[j]) + 1;
      const std::int64_t together =
          input.second - input.first + 1 + last_of(j) - firsts_[j] + 1 - overlap;
      const double iou = static_cast<double>(overlap) / static_cast<double>(together);
      if (iou > most) {
        most = iou;
        best = j;
      }
    }
    return best;
  }

  void move_last(std::size_t j, std::int64_t last) {
    const std::int64_t old = last_of(j);
    if (last == old) return;
    const auto at = [&](std::size_t index) {
      return firsts_.begin() + static_cast<std::ptrdiff_t>(index);
    };
    if (last < old) {
      if (old - last >= least_) {
        firsts_.insert(at(j + 1), last + 1);
      } else if (j + 1 < firsts_.size()) {
        firsts_[j + 1] = last + 1;
      }
      return;
    }
    while (j + 1 < firsts_.size() && last_of(j + 1) - last < least_) {
      firsts_.erase(at(j + 1));  // what is left of it goes to the one behind it
    }
    if (j + 1 < firsts_.size()) firsts_[j + 1] = last + 1;
  }

  void move_first(std::size_t j, std::int64_t first) {
    if (first == firsts_[j]) return;
    const auto at = [&](std::size_t index) {
      return firsts_.begin() + static_cast<std::ptrdiff_t>(index);
    };
    if (first > firsts_[j]) {
      if (first - firsts_[j] >= least_) {
        firsts_.insert(at(j + 1), first);
      } else if (j > 0) {
        firsts_[j] = first;
      }
      return;
    }
    // Those before it shrink; what is left of one and too short goes to the one before that.
    while (j > 0 && first - firsts_[j - 1] < least_) {
      firsts_.erase(at(j - 1));
      --j;
    }
    firsts_[j] = j == 0 ? 0 : first;
  }

  std::int64_t frames_;
  std::int64_t least_;
  std::vector<std::int64_t> firsts_;
};

}  // namespace

std::vector<Segment> refined(std::span<const Segment> inputs, std::int64_t frames,
                             std::int64_t least_length, std::span<const double> rates) {
  std::int64_t longest = 0;
  for (const auto& [first, last] : inputs) {
    if (first < 0 || last < first || last >= frames) fail("a segment outside of the database");
    longest = std::max(longest, last - first + 1);
  }
  if (frames == 0) return {};
  if (inputs.empty()) return {{0, frames - 1}};
  Layer layer(frames, longest, least_length);
  for (const double rate : rates) {
    for (const auto& input : inputs) layer.learn(input, rate);
  }
  return layer.segments();
}

}  // namespace mocapress::mrpa
