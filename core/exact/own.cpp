#include "exact/own.hpp"

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr std::size_t kPast = 3;  // differences
constexpr double kFading = 0.97;

MOCAPRESS_VECTOR_CLONES
void weigh(const Block* now, const Block* before, const Block* predictions, Block* usual,
           Block* weights, std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block error = (now[b] - before[b]) - predictions[b];
    const Block unusual = unusualness(error * error, usual[b]);
    for (std::size_t i = 0; i < kLanes; ++i) weights[b][i] = weight_of_frame(unusual[i], 1);
  }
}

}  // namespace

OwnChains::OwnChains(std::size_t channels)
    : chains_(channels, kPast + 1, kFading, kChainRidge),
      predictions_(channels, 0),
      moves_(channels, 0),
      usual_(channels, kChainRidge),
      weights_(channels, 0) {}

void OwnChains::begin(const Frames& frames) {
  for (std::size_t age = 1; age <= kPast; ++age) see(frames, age);
  chains_.predict_all(predictions_.blocks());
  for (std::size_t b = 0; b < moves_.count_blocks(); ++b) {
    const Block before = frames.row(1).block(b);
    moves_.block(b) = (before + predictions_.block(b)) - before;
  }
}

void OwnChains::learn(const Frames& frames) {
  see(frames, 0);
  weigh(frames.row(0).blocks(), frames.row(1).blocks(), predictions_.blocks(), usual_.blocks(),
        weights_.blocks(), weights_.count_blocks());
  chains_.learn(weights_.blocks());
}

void OwnChains::see(const Frames& frames, std::size_t age) {
  for (std::size_t b = 0; b < moves_.count_blocks(); ++b) {
    chains_.values(b)[kPast - age] = frames.row(age).block(b) - frames.row(age + 1).block(b);
  }
}

}  // namespace mocapress::exact
