#include "exact/law.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "exact/tables.hpp"
#include "numbers/arithmetic.hpp"

namespace mocapress::exact {
namespace {

constexpr int kMostSteps = 12;   // of the fixed point for y3
constexpr int kMiddleSteps = 8;  // of the fixed point for y of the second joint
constexpr double kFlattest = 0.1;
constexpr double kTurned = 1e-3;   // degrees; the same there
constexpr double kSettled = 1e-6;  // a step below it is the last
constexpr double kRight = 1e-3;    // degrees; a branch that is further off is the wrong one

Vector unit(const Vector& a) {
  const double length = std::max(std::sqrt(dot(a, a)), 1e-30);
  return {a[0] / length, a[1] / length, a[2] / length};
}

// Rz Ry Rx.
Matrix rotation(const SineCosine& x, const SineCosine& y, const SineCosine& z) {
  const auto [sx, cx] = x;
  const auto [sy, cy] = y;
  const auto [sz, cz] = z;
  return {{{cz * cy, sz * cy, -sy},
           {cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx},
           {cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx}}};
}

Matrix rotation(const double* degrees) {
  return rotation(sine_cosine(degrees[0] * kRadiansPerDegree),
                  sine_cosine(degrees[1] * kRadiansPerDegree),
                  sine_cosine(degrees[2] * kRadiansPerDegree));
}

// `a` turned as the shortest way from one unit vector to another turns it.
Vector swung(const Vector& from, const Vector& to, const Vector& a) {
  const Vector axis = cross(from, to);
  const double cosine = dot(from, to);
  const Vector moved = sum(scaled(a, cosine), cross(axis, a));
  return sum(moved, scaled(axis, dot(axis, a) / std::max(1 + cosine, 1e-9)));
}

// The turn about y that is left of the way from a to b after its swing.
double twist(const Matrix& a, const Matrix& b) {
  const Vector x = swung(a[1], b[1], a[0]);
  return arc_tangent(dot(x, b[2]), dot(x, b[0]));
}

// g and h of a branch, and each of their terms.
using Shares = double __attribute__((vector_size(2 * sizeof(double))));

// Of which term and variable each term is the product, by degree: 1, a, b, c, aa, ab, ...
struct Term {
  std::uint8_t of, times;
};

constexpr std::array<Term, 35> make_terms() {
  std::array<Term, 35> terms{};
  std::array<std::size_t, 4> from = {0, 0, 0, 1};  // where those without a, without a and b begin
  for (std::size_t made = 1; made < terms.size();) {
    std::array<std::size_t, 4> next{};
    for (std::size_t v = 0; v < 3; ++v) {
      next[v] = made;
      for (std::size_t i = from[v]; i < from[3]; ++i) {
        terms[made++] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(v)};
      }
    }
    next[3] = made;
    from = next;
  }
  return terms;
}

constexpr std::array<Term, 35> kTerms = make_terms();

MOCAPRESS_IN_PLACE Shares shares(const Branch& branch, const Vector& bends) {
  std::array<double, 35> terms;
  std::array<Shares, 4> sums{};  // none waits for another
  for (std::size_t i = 0; i < terms.size(); ++i) {
    terms[i] = i == 0 ? 1 : terms[kTerms[i].of] * bends[kTerms[i].times];
    sums[i % sums.size()] += Shares{branch.near[i], branch.root[i]} * terms[i];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// The value of a polynomial of degree 1.
double linear(const double* coefficients, const Vector& bends) {
  return coefficients[0] + coefficients[1] * bends[0] + coefficients[2] * bends[1] +
         coefficients[3] * bends[2];
}

std::span<const Branch> branches(LawKind kind) {
  if (kind == LawKind::spine) return kSpine.branches;
  return kNeck.branches;
}

std::span<const double> twist_table(LawKind kind) {
  if (kind == LawKind::spine) return kSpine.twist;
  return kNeck.twist;
}

constexpr Vector kUp = {0, 1, 0};

// The last joint's twist: odd in those of the joints before it and in how far they leave a plane.
double third_twist(std::span<const double> table, const Matrix& first, const Matrix& second,
                   const Vector& bends) {
  const std::array<double, 3> odd = {twist(kIdentity, first), twist(first, second),
                                     dot(kUp, cross(first[1], second[1]))};
  double turn = 0;
  std::size_t used = 0;
  for (const double factor : odd) {
    turn += factor * linear(table.data() + used, bends);
    used += 4;
  }
  for (int i = 0; i <= 3; ++i) {
    for (int j = 0; i + j <= 3; ++j) {
      double term = table[used++];
      for (int k = 0; k < 3; ++k) term *= k < i ? odd[0] : k < i + j ? odd[1] : odd[2];
      turn += term;
    }
  }
  return turn;
}

}  // namespace

std::size_t Law::sources(LawKind kind) {
  return kind <= LawKind::neck ? 6 : kind <= LawKind::other_thumb ? 2 : 5;
}

std::size_t Law::targets(LawKind kind) {
  return kind <= LawKind::neck ? 3 : kind <= LawKind::other_thumb ? 2 : 1;
}

void Law::begin(const double* sources) {
  if (kind_ <= LawKind::neck) return begin_chain(sources);
  if (kind_ >= LawKind::spine_middle) return begin_middle(sources);
  // The thumb points along (0.3, 0.5, 1) in the hand, which has turned by x.
  const auto [sine, cosine] = sine_cosine(sources[0] * kRadiansPerDegree);
  axis_ = {0.3, 0.5 * cosine + sine, cosine - 0.5 * sine};
  first_ = arc_sine(axis_[1] / std::sqrt(1.34)) / kRadiansPerDegree;
  const double away = 45 - arc_tangent(axis_[0], axis_[2]) / kRadiansPerDegree;
  thumb_turn_ = sources[1] + (kind_ == LawKind::thumb ? away : -away);
}

// The second joint's twist, which is about its turn y, is odd in that of the first and in how far
// the joints leave a plane; the latter depends on y.
void Law::begin_middle(const double* sources) {
  const auto& table = kind_ == LawKind::spine_middle ? kSpine.middle : kNeck.middle;
  const auto first = rotation(sources);
  const double turn = twist(kIdentity, first);
  const double bend = 1 - dot(kUp, first[1]);
  const SineCosine x = sine_cosine(sources[3] * kRadiansPerDegree);
  const SineCosine z = sine_cosine(sources[4] * kRadiansPerDegree);
  double last_off = 0;
  double moved = 0;
  for (int step = 0; step < kMiddleSteps; ++step) {
    const auto local = rotation(x, sine_cosine(first_ * kRadiansPerDegree), z);
    const Vector y2 = turned(first, local[1]);
    const Vector bends = {bend, 1 - dot(kUp, y2), 1 - dot(first[1], y2)};
    const double off_plane = dot(kUp, cross(first[1], y2));
    double told = turn * linear(table.data(), bends) + off_plane * linear(table.data() + 4, bends);
    for (std::size_t i = 0; i <= 3; ++i) {
      double term = table[8 + i];
      for (std::size_t k = 0; k < 3; ++k) term *= k < i ? turn : off_plane;
      told += term;
    }
    // A secant, whose slope is at first that of the frame before.
    const double off = (told - twist(kIdentity, local)) / kRadiansPerDegree;
    if (step > 0) slope_ = (off - last_off) / moved;
    moved = slope_ < -kFlattest ? -off / slope_ : off;
    last_off = off;
    first_ = std::clamp(first_ + moved, -90.0, 90.0);
    if (!(std::fabs(moved) > kTurned)) break;
  }
}

void Law::begin_chain(const double* sources) {
  const auto first = rotation(sources);
  const auto local = rotation(sources + 3);
  second_ = product(first, local);
  y1_ = first[1];
  axis_ = last_axis(branch_, bends_);
  const Vector bends = {1 - dot(kUp, y1_), 1 - dot(kUp, second_[1]), 1 - dot(y1_, second_[1])};
  const double turn = third_twist(twist_table(kind_), first, second_, bends);
  // From here on in the second joint, whose y axis is up: x and z of the last joint, swung there
  // and turned.
  const Vector x = swung(kUp, axis_, {1, 0, 0});
  const Vector z = swung(kUp, axis_, {0, 0, 1});
  const auto [sine, cosine] = sine_cosine(turn);
  first_ = arc_sine(-(cosine * x[2] - sine * z[2])) / kRadiansPerDegree;
}

// y2 is along y1 + g y3 + h y0, the y axes of parent and joints; g and h depend on the angles
// between y0, y1 and y3 alone. `bends` are where to start from, and what it ends with.
Vector Law::last_axis(std::size_t branch, std::array<double, 2>& bends) const {
  const Branch& table = branches(kind_)[branch];
  const double bend = 1 - dot(kUp, y1_);
  const Vector& y2 = second_[1];
  Vector y3 = y2;
  if (!(bends[0] >= 0 && bends[1] >= 0)) bends = {1 - dot(kUp, y2), 1 - dot(y1_, y2)};
  for (int step = 0; step < kMostSteps; ++step) {
    const Shares found_shares = shares(table, {bend, bends[0], bends[1]});
    const double near = found_shares[0];
    const double root = found_shares[1];
    const Vector rest = sum(y1_, scaled(kUp, root));
    const double along = dot(y2, rest);
    const double square = along * along - dot(rest, rest) + near * near;
    const double length = along + std::sqrt(std::max(square, 0.0));
    y3 = unit(sum(scaled(y2, length), scaled(rest, -1)));
    const std::array<double, 2> found = {1 - dot(kUp, y3), 1 - dot(y1_, y3)};
    const double moved = std::max(std::fabs(found[0] - bends[0]), std::fabs(found[1] - bends[1]));
    bends = found;
    if (moved < kSettled) break;
  }
  return {dot(second_[0], y3), dot(y2, y3), dot(second_[2], y3)};
}

// Takes the branch that comes nearest to the second target.
void Law::choose_branch(double seen, double cosine_y) {
  double nearest = 1e300;
  const std::array<double, 2> start = bends_;
  for (std::size_t branch = 0; branch < branches(kind_).size(); ++branch) {
    std::array<double, 2> bends = start;
    const Vector axis = last_axis(branch, bends);
    const double off = std::fabs(arc_sine(axis[2] / cosine_y) / kRadiansPerDegree - seen);
    if (!(off < nearest)) continue;
    nearest = off;
    branch_ = branch;
    axis_ = axis;
    bends_ = bends;
  }
}

double Law::predict(std::size_t target, const double* targets) {
  if (target == 0) return first_;
  if (kind_ > LawKind::neck) return thumb_turn_;
  const auto [sine_y, cosine_y] = sine_cosine(targets[0] * kRadiansPerDegree);
  const double second = arc_sine(axis_[2] / cosine_y) / kRadiansPerDegree;
  if (target == 1) return second;
  if (!(std::fabs(second - targets[1]) < kRight)) choose_branch(targets[1], cosine_y);
  const auto [sine_x, cosine_x] = sine_cosine(targets[1] * kRadiansPerDegree);
  return (arc_tangent(axis_[1], axis_[0]) - arc_tangent(cosine_x, sine_y * sine_x)) /
         kRadiansPerDegree;
}

}  // namespace mocapress::exact
