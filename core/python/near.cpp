#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>

#include "coding/sides.hpp"
#include "near/codec.hpp"
#include "near_encoding/encoder.hpp"
#include "near_encoding/leverage.hpp"
#include "python/bindings.hpp"
#include "python/skeleton.hpp"

namespace mocapress {
namespace {

using Columns = std::vector<std::pair<std::int32_t, std::string>>;

near::Measure measure_of(const nb::object& skeleton, const Columns& columns, bool radians,
                         double radius, const std::vector<double>& others) {
  near::Measure measure;
  measure.radians = radians;
  measure.radius = radius;
  if (others.size() != columns.size()) throw std::invalid_argument("levers of other columns");
  measure.others = others;
  if (skeleton.is_none()) return measure;
  std::vector<ChannelPlace> channels;
  for (const auto& [joint, word] : columns) {
    const auto* const kind = std::find(kKindNames.begin(), kKindNames.end(), word);
    const bool known = kind != kKindNames.end();
    channels.push_back(
        {known ? joint : -1, static_cast<Kind>(known ? kind - kKindNames.begin() : 0)});
  }
  measure.rig = std::make_shared<Rig>(skeleton_from(skeleton), channels, radians);
  return measure;
}

std::vector<double> vector_of(const Input<double, 1>& numbers, std::size_t count) {
  if (numbers.shape(0) != count) throw std::invalid_argument("numbers of other things");
  return {numbers.data(), numbers.data() + count};
}

Given<double, 1> levers(const near::Measure& measure, const Input<double, 2>& values,
                        const Input<double, 1>& weights) {
  const std::size_t frames = values.shape(0), channels = values.shape(1);
  const auto own = vector_of(weights, measure.points(channels));
  std::vector<double> sums(channels), costs(channels);
  {
    const nb::gil_scoped_release unlocked;
    std::vector<bool> moves(channels);
    for (std::size_t i = 0; i < frames * channels; ++i) {
      if (values.data()[i] != values.data()[i % channels]) moves[i % channels] = true;
    }
    near::Leverage leverage(measure, channels, own, moves);
    std::vector<float> shares(leverage.pairs());
    for (std::size_t f = 0; f < frames; ++f) {
      leverage.of_frame(values.data() + f * channels, costs.data(), shares.data());
      for (std::size_t c = 0; c < channels; ++c) {
        sums[c] += costs[c] / static_cast<double>(frames);
      }
    }
  }
  return give(std::move(sums));
}

Given<double, 2> errors(const near::Measure& measure, const Input<double, 2>& values,
                        const Input<double, 2>& others) {
  const std::size_t frames = values.shape(0), channels = values.shape(1);
  if (others.shape(0) != frames || others.shape(1) != channels) {
    throw std::invalid_argument("values of other frames or columns");
  }
  const std::size_t points = measure.points(channels);
  std::vector<double> found(frames * points);
  {
    const nb::gil_scoped_release unlocked;
    for (std::size_t f = 0; f < frames; ++f) {
      measure.errors(values.data() + f * channels, others.data() + f * channels, channels,
                     found.data() + f * points);
    }
  }
  return give(std::move(found), std::array{frames, points});
}

std::tuple<nb::bytes, Given<double, 2>, Given<double, 2>> encode(
    const near::Measure& measure, const Input<double, 2>& values, const nb::bytes& header,
    double scale, double rate, const Input<double, 1>& weights, double most,
    const Input<double, 1>& value_most, int rounds) {
  const std::size_t frames = values.shape(0), channels = values.shape(1);
  const near::Task task{near::read_header(view(header), channels),
                        scale,
                        rate,
                        vector_of(weights, measure.points(channels)),
                        most,
                        vector_of(value_most, channels),
                        rounds};
  near::Coded coded;
  {
    const nb::gil_scoped_release unlocked;
    coded = near::encode(values.data(), frames, task, measure);
  }
  const std::size_t points = measure.points(channels);
  return {to_python(coded.payload), give(std::move(coded.values), std::array{frames, channels}),
          give(std::move(coded.errors), std::array{frames, points})};
}

nb::bytes columns(std::vector<std::int64_t> apart, std::vector<std::int32_t> joints,
                  std::vector<std::int32_t> parents) {
  RangeWriting side;
  near::Joints told{std::move(joints), std::move(parents)};
  if (told.of_column.size() != apart.size()) throw std::invalid_argument("other columns");
  for (std::size_t c = 0; c < apart.size(); ++c) {
    const std::int32_t before = c > 0 ? told.of_column[c - 1] : -1, joint = told.of_column[c];
    const auto count = static_cast<std::int32_t>(told.parents.size());
    const bool counted = (c > 0 && joint == before) || (joint == before + 1 && joint < count);
    if (!counted || told.parents[static_cast<std::size_t>(joint)] >= joint) {
      throw std::invalid_argument("joints that are not counted as columns tell them");
    }
  }
  near::code_columns(side, apart, told);
  return to_python(side.finish());
}

void decode(const nb::bytes& header, const nb::bytes& payload, const Output<double, 2>& values) {
  const ByteView own = view(header), coded = view(payload);
  const nb::gil_scoped_release unlocked;
  const auto plan = near::read_header(own, values.shape(1));
  near::decode(coded, values.data(), values.shape(0), plan);
}

}  // namespace

void bind_near(nb::module_& module) {
  nb::class_<near::Measure>(module, "NearMeasure", "In what errors of `near` are measured.");
  module.def(
      "near_measure", &measure_of, nb::arg("skeleton").none(), nb::arg("columns"),
      nb::arg("radians"), nb::arg("radius"), nb::arg("others"),
      "Measure at points ``radius`` along the joints' axes, or values without a skeleton.\n\n"
      "``others``: what an error of 1 counts in each channel that moves no joint.");
  module.def("near_levers", &levers, nb::arg("measure"), nb::arg("values"), nb::arg("weights"),
             "Give the mean square of how far each channel moves the points, (C,).");
  module.def("near_errors", &errors, nb::arg("measure"), nb::arg("values"), nb::arg("others"),
             "Give the errors of joints, (F, J), or without a skeleton of values, (F, C).");
  module.def("near_columns", &columns, nb::arg("apart"), nb::arg("joints"), nb::arg("parents"),
             "Code what columns have of their own, for the header.");
  module.def("near_encode", &encode, nb::arg("measure"), nb::arg("values"), nb::arg("header"),
             nb::arg("scale"), nb::arg("rate"), nb::arg("weights"), nb::arg("most"),
             nb::arg("value_most"), nb::arg("rounds"),
             "Code rows as a chunk: its payload, the values that it decodes to, and the errors of\n"
             "joints, (F, J), or without a skeleton of values, (F, C).");
  module.def("near_decode", &decode, nb::arg("header"), nb::arg("payload"),
             nb::arg("values").noconvert(),
             "Fill ``values`` from a chunk; ValueError where it is none.");
}

}  // namespace mocapress
