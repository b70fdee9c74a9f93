// Quaternion space sparse decomposition: frames as products of powers of a dictionary's atoms.
//
// M. Zhu, H. Sun, Z. Deng: "Quaternion Space Sparse Decomposition for Motion Compression and
// Retrieval", Computer Graphics Forum 31 (2012). Where it leaves something open:
// docs/papers/qssd.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace mocapress::qssd {

// What is done where a coefficient would have to stand elsewhere in the product.
enum class Order : std::uint8_t {
  stop,  // its magnitude is limited, as the order of selection asks: the paper's
  sort,  // it moves there
};

struct Frames {
  const double* turns;  // (frames, joints, 4) unit quaternions, scalar first
  std::size_t frames;
  std::size_t joints;
  const double* importance;  // (joints): what the angles of a joint are multiplied by
};

// (atoms, joints, 3): logarithms of the dictionary, of length 1 in angles times importance.
struct Dictionary {
  double* logarithms;
  std::size_t atoms;
};

// (frames, most): each frame's atoms in the order of their product, -1 behind the last.
struct Weights {
  std::int32_t* atoms;
  double* weights;
  std::size_t most;
};

// When a frame has enough atoms, beside `most` of them.
struct Enough {
  double tolerance;  // what is left is no longer than this
  double least;      // no atom has a larger projection of it
};

// Algorithm 2.
void code_by_products(const Frames& frames, const Dictionary& dictionary, const Weights& weights,
                      const Enough& enough, Order order);

// Makes the weights multiples of `step`, each the best beside those of the other atoms; `rounding`
// is what is added before the fraction is cut off, 1/2 for the nearest. Those that become 0 leave
// their frames; the others stand in the order of their product.
void quantize_products(const Frames& frames, const Dictionary& dictionary, const Weights& weights,
                       double step, double rounding);

// Algorithm 3: all atoms, one after the other, and their weights. Atoms that no frame uses stay.
void learn_products(const Frames& frames, const Dictionary& dictionary, const Weights& weights);

// Eq. 3, in the order of magnitudes: fills (frames, joints, 4).
void combine_products(double* turns, std::size_t frames, std::size_t joints,
                      const Dictionary& dictionary, const Weights& weights);

}  // namespace mocapress::qssd
