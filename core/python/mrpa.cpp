#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <tuple>

#include "mrpa/codec.hpp"
#include "mrpa/paths.hpp"
#include "mrpa/segments.hpp"
#include "python/bindings.hpp"
#include "python/float_columns.hpp"

namespace mocapress {
namespace {

// Frames, parent, fresh.
using PieceTable = Plan<std::int64_t, 3>;

std::vector<mrpa::Piece> pieces_of(const PieceTable& table, std::size_t frames) {
  std::vector<mrpa::Piece> pieces(table.shape(0));
  std::size_t left = frames;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const std::int64_t* row = table.data() + 3 * i;
    if (row[0] < 0 || static_cast<std::uint64_t>(row[0]) > left) {
      throw std::invalid_argument("pieces that are not the rows");
    }
    pieces[i] = {static_cast<std::size_t>(row[0]), row[1] != 0, row[2] != 0};
    left -= pieces[i].frames;
  }
  if (left != 0) throw std::invalid_argument("pieces that are not the rows");
  return pieces;
}

template <class Values>
void check_parents(const Values& values, const Input<double, 2>& parents) {
  if (values.shape(0) != parents.shape(0) || values.shape(1) != parents.shape(1)) {
    throw std::invalid_argument("not as many parents as values");
  }
}

nb::bytes encode(const Input<double, 2>& values, const Input<double, 2>& parents,
                 const PieceTable& table, const FloatPlan& plan, int mantissa_limit, int choice) {
  check_parents(values, parents);
  const auto columns = float_columns(plan, values.shape(1));
  const auto pieces = pieces_of(table, values.shape(0));
  Bytes payload;
  {
    nb::gil_scoped_release unlocked;
    payload = mrpa::encode({values.data(), parents.data(), pieces, columns}, mantissa_limit,
                           static_cast<mrpa::Choice>(choice));
  }
  return to_python(payload);
}

void decode(const nb::bytes& payload, const Output<double, 2>& values,
            const Input<double, 2>& parents, const PieceTable& table, const FloatPlan& plan,
            int mantissa_limit) {
  check_parents(values, parents);
  const auto columns = float_columns(plan, values.shape(1));
  const auto pieces = pieces_of(table, values.shape(0));
  const ByteView bytes = view(payload);
  nb::gil_scoped_release unlocked;
  mrpa::decode(bytes, values.data(), parents.data(), pieces, columns, mantissa_limit);
}

std::vector<double> estimated_bits(const Input<double, 2>& values, const Input<double, 2>& parents,
                                   const PieceTable& table, const FloatPlan& plan) {
  check_parents(values, parents);
  const auto columns = float_columns(plan, values.shape(1));
  const auto pieces = pieces_of(table, values.shape(0));
  nb::gil_scoped_release unlocked;
  return mrpa::estimated_bits({values.data(), parents.data(), pieces, columns});
}

std::vector<std::uint8_t> weights_of(const Input<double, 2>& values,
                                     const Input<double, 2>& parents, const PieceTable& table,
                                     const FloatPlan& plan) {
  check_parents(values, parents);
  const auto columns = float_columns(plan, values.shape(1));
  const auto pieces = pieces_of(table, values.shape(0));
  nb::gil_scoped_release unlocked;
  return mrpa::weights_of({values.data(), parents.data(), pieces, columns});
}

auto grow(const Input<std::int64_t, 1>& starts, const Input<std::int32_t, 1>& matches,
          const Input<float, 1>& distances, const Input<std::int32_t, 1>& clips,
          std::int32_t least_depth, bool deepest) {
  mrpa::Paths paths;
  {
    nb::gil_scoped_release unlocked;
    paths = mrpa::grow({{starts.data(), starts.size()},
                        {matches.data(), matches.size()},
                        {distances.data(), distances.size()},
                        {clips.data(), clips.size()}},
                       least_depth, deepest ? mrpa::Keep::deepest : mrpa::Keep::nearest);
  }
  return std::make_tuple(give(std::move(paths.first)), give(std::move(paths.begin)),
                         give(std::move(paths.vertical)), give(std::move(paths.distance)));
}

auto refined(const Input<std::int64_t, 2>& inputs, std::int64_t frames, std::int64_t least_length,
             const std::vector<double>& rates) {
  if (inputs.shape(1) != 2) throw std::invalid_argument("segments have a first and a last frame");
  std::vector<mrpa::Segment> segments(inputs.shape(0));
  for (std::size_t i = 0; i < segments.size(); ++i) {
    segments[i] = {inputs.data()[2 * i], inputs.data()[2 * i + 1]};
  }
  std::vector<std::int64_t> flat;
  {
    nb::gil_scoped_release unlocked;
    for (const auto& [first, last] : mrpa::refined(segments, frames, least_length, rates)) {
      flat.push_back(first);
      flat.push_back(last);
    }
  }
  const std::array<std::size_t, 2> shape{flat.size() / 2, 2};
  return give(std::move(flat), shape);
}

}  // namespace

void bind_mrpa(nb::module_& module) {
  const auto values = nb::arg("values");
  const auto parents = nb::arg("parents");
  const auto pieces = nb::arg("pieces");
  const auto plan = nb::arg("plan");
  const auto limit = nb::arg("mantissa_limit");
  module.def("mrpa_encode", &encode, values, parents, pieces, plan, limit, nb::arg("choice"),
             "Code rows as a chunk; pieces are frames, whether with a parent, whether fresh.\n\n"
             "``choice``: see core/mrpa/codec.hpp; the plan is that of ``app_encode``.");
  module.def("mrpa_decode", &decode, nb::arg("payload"), nb::arg("values").noconvert(), parents,
             pieces, plan, limit, "Fill ``values`` from a chunk; ValueError where it is none.");
  module.def("mrpa_weights", &weights_of, values, parents, pieces, plan,
             "Give the numbers of alpha and beta that are best, for each piece of each column.");
  module.def("mrpa_estimated_bits", &estimated_bits, values, parents, pieces, plan,
             "Give about how many bits each piece takes without its parent and with it, by turns.");
  module.def("mrpa_grow", &grow, nb::arg("starts"), nb::arg("matches"), nb::arg("distances"),
             nb::arg("clips"), nb::arg("least_depth"), nb::arg("deepest"),
             "Give paths: first frames, where each begins in the next, matches, distances.");
  module.def("mrpa_refined", &refined, nb::arg("inputs"), nb::arg("frames"),
             nb::arg("least_length"), nb::arg("rates"),
             "Give the segments that learn from the inputs, (S, 2): first and last frames.");
}

}  // namespace mocapress
