#include "qssd_learning/products.hpp"

#include <array>
#include <vector>

#include "numbers/vector_clones.hpp"
#include "qssd_learning/first_pair.hpp"
#include "qssd_learning/parallel.hpp"
#include "qssd_learning/sparse.hpp"
#include "qssd_learning/turns.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// As in core/motion/kinematics.cpp: no fused operations of sums and differences side by side.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress::qssd {
namespace {

constexpr int kMostSweeps = 100;
constexpr int kMostRoundings = 8;
constexpr double kSettled = 1e-4;  // of a frame's largest weight
constexpr double kNothing = 1e-12;
constexpr std::size_t kLeastFrames = 64;  // for which a thread is worth its start

template <class Value>
using Aligned = std::vector<Value, BlockAllocator<Value>>;

constexpr Turns kNoTurn = {Block{} + 1.0, Block{}, Block{}, Block{}};

// What an atom does to eight joints: about which axes, by which half angles at the weight 1.
struct Part {
  Arcs axis;
  Block half;
};

MOCAPRESS_IN_PLACE Part part_of(const Arcs& log) {
  const Block half = root(dot(log, log));
  const Block by = half == 0 ? Block{} + 1.0 : half;
  return {{log.x / by, log.y / by, log.z / by}, half};
}

MOCAPRESS_IN_PLACE Turns power(const Part& part, double weight) {
  const Waves waves = waves_of(weight * part.half);
  return {waves.cosine, waves.sine * part.axis.x, waves.sine * part.axis.y,
          waves.sine * part.axis.z};
}

// Numbers of each joint, (joints, 3 or 4), as blocks of eight joints.
template <class Into, std::size_t kFields>
void load(const double* from, std::size_t joints, Into* into) {
  for (std::size_t j = 0; j < joints; ++j) {
    auto* block = reinterpret_cast<double*>(into + j / kLanes);
    for (std::size_t field = 0; field < kFields; ++field) {
      block[field * kLanes + j % kLanes] = from[j * kFields + field];
    }
  }
}

template <class From, std::size_t kFields>
void store(const From* from, std::size_t joints, double* into) {
  for (std::size_t j = 0; j < joints; ++j) {
    const auto* block = reinterpret_cast<const double*>(from + j / kLanes);
    for (std::size_t field = 0; field < kFields; ++field) {
      into[j * kFields + field] = block[field * kLanes + j % kLanes];
    }
  }
}

struct Atoms {
  std::size_t blocks;
  Aligned<Arcs> logs;
  Aligned<Part> parts;
  Blocks squares;  // of the joints' importance

  Atoms(const Dictionary& dictionary, std::size_t joints, const double* importance)
      : blocks(blocks_of(joints)), logs(dictionary.atoms * blocks), squares(blocks) {
    for (std::size_t k = 0; k < dictionary.atoms; ++k) {
      load<Arcs, 3>(dictionary.logarithms + k * joints * 3, joints, logs.data() + k * blocks);
    }
    for (std::size_t j = 0; j < joints; ++j) {
      squares[j / kLanes][j % kLanes] = importance[j] * importance[j];
    }
    for (const Arcs& log : logs) parts.push_back(part_of(log));
  }
};

Aligned<Turns> blocks_of_turns(const Frames& frames) {
  const std::size_t blocks = blocks_of(frames.joints);
  Aligned<Turns> turns(frames.frames * blocks, kNoTurn);
  for (std::size_t f = 0; f < frames.frames; ++f) {
    load<Turns, 4>(frames.turns + f * frames.joints * 4, frames.joints, turns.data() + f * blocks);
  }
  return turns;
}

// The coefficient by which an atom comes nearest to what is left (Eq. 6), weighted.
MOCAPRESS_IN_PLACE double best_weight(const Turns* left, const Part* parts, const Block* squares,
                                      std::size_t blocks) {
  Block over{};
  Block under{};
  for (std::size_t b = 0; b < blocks; ++b) {
    const Arcs imaginary = {left[b].x, left[b].y, left[b].z};
    const Block angle = arc_of(dot(imaginary, parts[b].axis), left[b].w);
    over += squares[b] * parts[b].half * angle;
    under += squares[b] * parts[b].half * parts[b].half;
  }
  const double norm = total(under);
  return norm > 0 ? total(over) / norm : 0;
}

// One frame while it is coded.
struct Bench {
  Aligned<Turns> left;    // what the atoms so far leave
  Aligned<Turns> behind;  // the products of the atoms behind each
  Aligned<Turns> trial;
  Aligned<Arcs> logs;

  explicit Bench(std::size_t blocks)
      : left(blocks), behind((kMostAtoms + 1) * blocks), trial(blocks), logs(blocks) {}
};

// One sweep of the block coordinate descent: each weight becomes what `limit` makes of the best
// beside the others. Gives the largest move.
template <class Limit>
MOCAPRESS_IN_PLACE double sweep(const Turns* frame, const Atoms& atoms, const Picked& picked,
                                std::size_t count, Bench& bench, const Limit& limit) {
  const std::size_t blocks = atoms.blocks;
  Turns* const behind = bench.behind.data();
  for (std::size_t b = 0; b < blocks; ++b) behind[(count - 1) * blocks + b] = kNoTurn;
  for (std::size_t p = count; --p > 0;) {
    const Part* parts = atoms.parts.data() + picked.atoms[p] * blocks;
    for (std::size_t b = 0; b < blocks; ++b) {
      behind[(p - 1) * blocks + b] =
          product(power(parts[b], picked.weights[p]), behind[p * blocks + b]);
    }
  }
  for (std::size_t b = 0; b < blocks; ++b) bench.left[b] = frame[b];
  double moved = 0;
  for (std::size_t p = 0; p < count; ++p) {
    const Part* parts = atoms.parts.data() + picked.atoms[p] * blocks;
    for (std::size_t b = 0; b < blocks; ++b) {
      bench.trial[b] = product(bench.left[b], conjugate(behind[p * blocks + b]));
    }
    const double best = best_weight(bench.trial.data(), parts, atoms.squares.data(), blocks);
    const double weight = limit(p, best);
    moved = std::max(moved, std::fabs(weight - picked.weights[p]));
    picked.weights[p] = weight;
    for (std::size_t b = 0; b < blocks; ++b) {
      bench.left[b] = product(conjugate(power(parts[b], weight)), bench.left[b]);
    }
  }
  return moved;
}

// Within the limits that the order of selection leaves.
MOCAPRESS_IN_PLACE double sweep_in_order(const Turns* frame, const Atoms& atoms,
                                         const Picked& picked, std::size_t count, Bench& bench) {
  return sweep(frame, atoms, picked, count, bench, [&](std::size_t p, double weight) {
    double magnitude = std::fabs(weight);
    if (p > 0) magnitude = std::min(magnitude, std::fabs(picked.weights[p - 1]));
    if (p + 1 < count) magnitude = std::max(magnitude, std::fabs(picked.weights[p + 1]));
    return weight < 0 ? -magnitude : magnitude;
  });
}

MOCAPRESS_IN_PLACE double sweep_freely(const Turns* frame, const Atoms& atoms, const Picked& picked,
                                       std::size_t count, Bench& bench) {
  return sweep(frame, atoms, picked, count, bench,
               [](std::size_t, double weight) { return weight; });
}

// The atom with the largest projection of what is left (line 4 and 5), -1 where nothing is left.
MOCAPRESS_IN_PLACE std::int32_t best_atom(const Atoms& atoms, std::size_t count,
                                          const Enough& enough, const Picked& picked,
                                          std::size_t chosen, Bench& bench) {
  const std::size_t blocks = atoms.blocks;
  Block squares{};
  for (std::size_t b = 0; b < blocks; ++b) {
    const Arcs log = logarithm(bench.left[b]);
    const Block weight = atoms.squares[b];
    squares += weight * dot(log, log);
    bench.logs[b] = {weight * log.x, weight * log.y, weight * log.z};
  }
  if (total(squares) <= enough.tolerance * enough.tolerance) return -1;
  std::int32_t best = -1;
  double most = std::max(kNothing, enough.least);
  for (std::size_t k = 0; k < count; ++k) {
    const Arcs* log = atoms.logs.data() + k * blocks;
    Block sum{};
    for (std::size_t b = 0; b < blocks; ++b) sum += dot(bench.logs[b], log[b]);
    const double projection = std::fabs(total(sum));
    if (projection <= most) continue;
    const auto end = picked.atoms.begin() + static_cast<std::ptrdiff_t>(chosen);
    if (std::find(picked.atoms.begin(), end, static_cast<std::int32_t>(k)) != end) continue;
    most = projection;
    best = static_cast<std::int32_t>(k);
  }
  return best;
}

MOCAPRESS_VECTOR_CLONES
void code_slice(const Turns* turns, std::size_t first, std::size_t last, const Atoms& atoms,
                std::size_t atom_count, const Weights& weights, const Enough& enough, Order order) {
  const std::size_t blocks = atoms.blocks;
  Bench bench(blocks);
  for (std::size_t f = first; f < last; ++f) {
    const Turns* frame = turns + f * blocks;
    const Picked picked = {{weights.atoms + f * weights.most, weights.most},
                           {weights.weights + f * weights.most, weights.most}};
    for (std::size_t b = 0; b < blocks; ++b) bench.left[b] = frame[b];
    for (std::size_t count = 0; count < weights.most;) {
      const std::int32_t best = best_atom(atoms, atom_count, enough, picked, count, bench);
      if (best < 0) break;
      const Part* parts = atoms.parts.data() + best * blocks;
      double weight = best_weight(bench.left.data(), parts, atoms.squares.data(), blocks);
      const bool kept = order == Order::stop;
      if (kept && count > 0 && std::fabs(weight) > std::fabs(picked.weights[count - 1])) {
        weight = std::copysign(picked.weights[count - 1], weight);
      }
      picked.atoms[count] = best;
      picked.weights[count++] = weight;
      bool moved = !kept && put_in_order(picked, count);
      for (int round = 0; round < kMostSweeps; ++round) {
        const double move = kept ? sweep_in_order(frame, atoms, picked, count, bench)
                                 : sweep_freely(frame, atoms, picked, count, bench);
        moved = !kept && put_in_order(picked, count);
        if (!moved && move <= kSettled * std::fabs(picked.weights[0])) break;
      }
      if (moved) sweep_in_order(frame, atoms, picked, count, bench);
    }
  }
}

// A multiple of `step`.
MOCAPRESS_IN_PLACE double rounded(double weight, double step, double rounding) {
  const double steps = std::floor(std::fabs(weight) / step + rounding);
  return weight < 0 ? -steps * step : steps * step;
}

MOCAPRESS_VECTOR_CLONES
void quantize_slice(const Turns* turns, std::size_t first, std::size_t last, const Atoms& atoms,
                    const Weights& weights, double step, double rounding) {
  const std::size_t blocks = atoms.blocks;
  Bench bench(blocks);
  for (std::size_t f = first; f < last; ++f) {
    const Picked picked = {{weights.atoms + f * weights.most, weights.most},
                           {weights.weights + f * weights.most, weights.most}};
    const std::size_t chosen = picked.count();
    for (std::size_t p = 0; p < chosen; ++p) {
      picked.weights[p] = rounded(picked.weights[p], step, rounding);
    }
    put_in_order(picked, chosen);
    std::size_t count = chosen;
    for (int round = 0; round < kMostRoundings; ++round) {
      while (count > 0 && picked.weights[count - 1] == 0) picked.atoms[--count] = -1;
      if (count == 0) break;
      const double move =
          sweep(turns + f * blocks, atoms, picked, count, bench,
                [&](std::size_t, double weight) { return rounded(weight, step, rounding); });
      if (!put_in_order(picked, count) && move == 0) break;
    }
    while (count > 0 && picked.weights[count - 1] == 0) picked.atoms[--count] = -1;
  }
}

struct Use {
  std::size_t frame, at;
};

// What the other atoms of a frame leave for one of them (Algorithm 3, line 5), as a row of angles
// times importance.
MOCAPRESS_VECTOR_CLONES
void residual_rows(const Turns* turns, const Use* uses, std::size_t first, std::size_t last,
                   const Atoms& atoms, const Block* importance, const Weights& weights,
                   Block* rows) {
  const std::size_t blocks = atoms.blocks;
  Aligned<Turns> left(blocks);
  std::array<std::int32_t, kMostAtoms> own_atoms;
  std::array<double, kMostAtoms> own_weights;
  for (std::size_t u = first; u < last; ++u) {
    const std::int32_t* atoms_of = weights.atoms + uses[u].frame * weights.most;
    const double* weights_of = weights.weights + uses[u].frame * weights.most;
    const std::int32_t atom = atoms_of[uses[u].at];
    std::copy_n(atoms_of, weights.most, own_atoms.begin());
    std::copy_n(weights_of, weights.most, own_weights.begin());
    const Picked picked = {{own_atoms.data(), weights.most}, {own_weights.data(), weights.most}};
    const std::size_t count = picked.count();
    put_in_order(picked, count);
    for (std::size_t b = 0; b < blocks; ++b) left[b] = turns[uses[u].frame * blocks + b];
    std::size_t p = 0;
    for (; picked.atoms[p] != atom; ++p) {  // Phi 1
      const Part* parts = atoms.parts.data() + picked.atoms[p] * blocks;
      for (std::size_t b = 0; b < blocks; ++b) {
        left[b] = product(conjugate(power(parts[b], picked.weights[p])), left[b]);
      }
    }
    for (std::size_t q = count; --q > p;) {  // Phi 2
      const Part* parts = atoms.parts.data() + picked.atoms[q] * blocks;
      for (std::size_t b = 0; b < blocks; ++b) {
        left[b] = product(left[b], conjugate(power(parts[b], picked.weights[q])));
      }
    }
    for (std::size_t b = 0; b < blocks; ++b) {
      const Arcs log = logarithm(left[b]);
      Block* const row = rows + (u * blocks + b) * 3;
      row[0] = log.x * importance[b];
      row[1] = log.y * importance[b];
      row[2] = log.z * importance[b];
    }
  }
}

MOCAPRESS_VECTOR_CLONES
bool pair_of(const Block* rows, std::size_t count, std::size_t blocks, Block* direction,
             double* along, Block* scratch) {
  return first_pair(rows, count, blocks, direction, along, scratch);
}

MOCAPRESS_VECTOR_CLONES
void combine_slice(Turns* turns, std::size_t first, std::size_t last, const Atoms& atoms,
                   const Weights& weights) {
  const std::size_t blocks = atoms.blocks;
  std::array<std::int32_t, kMostAtoms> own_atoms;
  std::array<double, kMostAtoms> own_weights;
  for (std::size_t f = first; f < last; ++f) {
    std::copy_n(weights.atoms + f * weights.most, weights.most, own_atoms.begin());
    std::copy_n(weights.weights + f * weights.most, weights.most, own_weights.begin());
    const Picked picked = {{own_atoms.data(), weights.most}, {own_weights.data(), weights.most}};
    const std::size_t count = picked.count();
    put_in_order(picked, count);
    for (std::size_t p = 0; p < count; ++p) {
      const Part* parts = atoms.parts.data() + picked.atoms[p] * blocks;
      for (std::size_t b = 0; b < blocks; ++b) {
        Turns& turn = turns[f * blocks + b];
        turn = product(turn, power(parts[b], picked.weights[p]));
      }
    }
  }
}

}  // namespace

void code_by_products(const Frames& frames, const Dictionary& dictionary, const Weights& weights,
                      const Enough& enough, Order order) {
  const Atoms atoms(dictionary, frames.joints, frames.importance);
  const Aligned<Turns> turns = blocks_of_turns(frames);
  in_parallel(frames.frames, kLeastFrames, [&](std::size_t first, std::size_t last) {
    code_slice(turns.data(), first, last, atoms, dictionary.atoms, weights, enough, order);
  });
}

void quantize_products(const Frames& frames, const Dictionary& dictionary, const Weights& weights,
                       double step, double rounding) {
  const Atoms atoms(dictionary, frames.joints, frames.importance);
  const Aligned<Turns> turns = blocks_of_turns(frames);
  in_parallel(frames.frames, kLeastFrames, [&](std::size_t first, std::size_t last) {
    quantize_slice(turns.data(), first, last, atoms, weights, step, rounding);
  });
}

void learn_products(const Frames& frames, const Dictionary& dictionary, const Weights& weights) {
  Atoms atoms(dictionary, frames.joints, frames.importance);
  const std::size_t blocks = atoms.blocks;
  const Aligned<Turns> turns = blocks_of_turns(frames);
  Blocks importance(blocks, Block{} + 1.0);
  for (std::size_t j = 0; j < frames.joints; ++j) {
    importance[j / kLanes][j % kLanes] = frames.importance[j];
  }
  std::vector<std::vector<Use>> uses(dictionary.atoms);
  for (std::size_t i = 0; i < frames.frames * weights.most; ++i) {
    if (weights.atoms[i] >= 0) {
      uses[weights.atoms[i]].push_back({i / weights.most, i % weights.most});
    }
  }
  Blocks direction(3 * blocks);
  Blocks scratch(3 * blocks);
  for (std::size_t k = 0; k < dictionary.atoms; ++k) {
    const auto& used = uses[k];
    if (used.empty()) continue;
    Blocks rows(used.size() * blocks * 3);
    in_parallel(used.size(), kLeastFrames, [&](std::size_t first, std::size_t last) {
      residual_rows(turns.data(), used.data(), first, last, atoms, importance.data(), weights,
                    rows.data());
    });
    for (std::size_t b = 0; b < blocks; ++b) {
      const Arcs& log = atoms.logs[k * blocks + b];
      direction[3 * b] = log.x * importance[b];
      direction[3 * b + 1] = log.y * importance[b];
      direction[3 * b + 2] = log.z * importance[b];
    }
    std::vector<double> along(used.size());
    if (!pair_of(rows.data(), used.size(), 3 * blocks, direction.data(), along.data(),
                 scratch.data()))
      continue;
    for (std::size_t b = 0; b < blocks; ++b) {
      const Arcs log = {direction[3 * b] / importance[b], direction[3 * b + 1] / importance[b],
                        direction[3 * b + 2] / importance[b]};
      atoms.logs[k * blocks + b] = log;
      atoms.parts[k * blocks + b] = part_of(log);
    }
    for (std::size_t u = 0; u < used.size(); ++u) {
      weights.weights[used[u].frame * weights.most + used[u].at] = along[u];
    }
  }
  for (std::size_t k = 0; k < dictionary.atoms; ++k) {
    store<Arcs, 3>(atoms.logs.data() + k * blocks, frames.joints,
                   dictionary.logarithms + k * frames.joints * 3);
  }
}

void combine_products(double* turns, std::size_t frames, std::size_t joints,
                      const Dictionary& dictionary, const Weights& weights) {
  const std::vector<double> importance(joints, 1.0);
  const Atoms atoms(dictionary, joints, importance.data());
  Aligned<Turns> made(frames * atoms.blocks, kNoTurn);
  in_parallel(frames, kLeastFrames, [&](std::size_t first, std::size_t last) {
    combine_slice(made.data(), first, last, atoms, weights);
  });
  for (std::size_t f = 0; f < frames; ++f) {
    store<Turns, 4>(made.data() + f * atoms.blocks, joints, turns + f * joints * 4);
  }
}

}  // namespace mocapress::qssd
