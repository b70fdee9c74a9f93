#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "coding/sides.hpp"
#include "near/codec.hpp"
#include "near/start.hpp"
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
    const near::Measure& measure, const near::Measure& curves, const Input<double, 2>& values,
    const nb::bytes& header, double scale, double rate, bool tries_knots,
    const Input<double, 1>& weights, const Input<double, 1>& most,
    const Input<double, 1>& value_most, const Input<std::uint8_t, 2>& kept, int rounds) {
  const std::size_t frames = values.shape(0), channels = values.shape(1);
  const std::size_t points = measure.points(channels);
  if (kept.shape(0) != frames || kept.shape(1) != channels) {
    throw std::invalid_argument("what is kept of other values");
  }
  near::Plan plan = near::read_header(view(header), channels);
  plan.order.clear();  // the columns come as they are coded
  const near::Task task{std::move(plan),
                        scale,
                        rate,
                        tries_knots,
                        vector_of(weights, points),
                        vector_of(most, points),
                        vector_of(value_most, channels),
                        std::vector<bool>(kept.data(), kept.data() + frames * channels),
                        rounds};
  near::Coded coded;
  {
    const nb::gil_scoped_release unlocked;
    coded = near::encode(values.data(), frames, task, measure, curves);
  }
  return {to_python(coded.payload), give(std::move(coded.values), std::array{frames, channels}),
          give(std::move(coded.errors), std::array{frames, points})};
}

// Of each: its first column; the orders of the file's columns and axes, and of the curves' axes;
// whether the file's angles are the nearest to zero.
std::vector<near::Turning> turnings_of(const std::vector<std::array<int, 5>>& told) {
  std::vector<near::Turning> found;
  for (const auto& [first, columns, axes, curves, nearest] : told) {
    if (first < 0 || std::min({columns, axes, curves}) < 0 ||
        std::max({columns, axes, curves}) > 5) {
      throw std::invalid_argument("no order of three turns");
    }
    found.push_back({static_cast<std::size_t>(first), static_cast<std::uint8_t>(columns),
                     static_cast<std::uint8_t>(axes), static_cast<std::uint8_t>(curves),
                     nearest != 0});
  }
  return found;
}

// The joints whose last columns are three angles about different axes, as turnings that keep the
// file's order.
std::vector<std::array<int, 5>> turnable(const near::Measure& measure, const Columns& columns) {
  std::vector<std::array<int, 5>> found;
  if (!measure.rig) return found;
  const Rig& rig = *measure.rig;
  const auto order_of = [](const near::Order& order) {
    const auto* const at = std::find(near::kOrders.begin(), near::kOrders.end(), order);
    return static_cast<int>(at - near::kOrders.begin());
  };
  for (std::size_t j = 0; j < rig.joints(); ++j) {
    const auto& turns = rig.turns(j);
    if (turns.size() != 3) continue;
    std::size_t first = turns[0].column;
    for (const auto& turn : turns) first = std::min(first, turn.column);
    near::Order places{}, axes{};
    std::size_t furthest = first;
    for (std::size_t i = 0; i < 3; ++i) {
      furthest = std::max(furthest, turns[i].column);
      places[i] = static_cast<std::uint8_t>(turns[i].column - first);
      axes[i] = static_cast<std::uint8_t>(turns[i].axis);
    }
    const bool last =
        furthest + 1 == columns.size() || columns[furthest + 1].first != columns[furthest].first;
    if (furthest != first + 2 || !last || order_of(places) > 5 || order_of(axes) > 5) continue;
    found.push_back({static_cast<int>(first), order_of(places), order_of(axes), order_of(axes), 0});
  }
  std::sort(found.begin(), found.end());
  return found;
}

// The same measure of channels as curves turn them.
near::Measure turned_measure(const near::Measure& measure,
                             const std::vector<std::array<int, 5>>& told) {
  near::Measure turned = measure;
  if (!measure.rig) return turned;
  Rig rig = *measure.rig;
  for (const near::Turning& turning : turnings_of(told)) {
    const auto& axes = near::kOrders[turning.curves];
    for (std::size_t j = 0; j < rig.joints(); ++j) {
      const auto& turns = rig.turns(j);
      const bool own = std::any_of(turns.begin(), turns.end(),
                                   [&](const auto& turn) { return turn.column == turning.first; });
      if (!own) continue;
      rig.turn_by(
          j,
          {{turning.first, axes[0]}, {turning.first + 1, axes[1]}, {turning.first + 2, axes[2]}});
    }
  }
  turned.rig = std::make_shared<Rig>(std::move(rig));
  return turned;
}

near::Plan plan_of(const std::vector<std::array<int, 5>>& told, std::size_t channels,
                   bool radians) {
  near::Plan plan;
  plan.turnings = turnings_of(told);
  plan.radians = radians;
  plan.steps.resize(channels);
  for (const near::Turning& turning : plan.turnings) {
    if (turning.first + 3 > channels) throw std::invalid_argument("turns of other columns");
  }
  return plan;
}

Given<double, 2> turned_values(const near::Measure& measure, const Input<double, 2>& values,
                               const std::vector<std::array<int, 5>>& told) {
  const std::size_t frames = values.shape(0), channels = values.shape(1);
  const near::Plan plan = plan_of(told, channels, measure.radians);
  return give(near::turned({values.data(), values.data() + frames * channels}, plan),
              std::array{frames, channels});
}

// In how many frames each turning gives other angles back than the file's, if of the same turn.
std::vector<std::size_t> unlike(const near::Measure& measure, const Input<double, 2>& values,
                                const std::vector<std::array<int, 5>>& told) {
  const std::size_t frames = values.shape(0), channels = values.shape(1);
  const near::Plan plan = plan_of(told, channels, measure.radians);
  const double* const given = values.data();
  std::vector<double> back = near::turned({given, given + frames * channels}, plan);
  std::vector<near::Angles> starts;
  for (const near::Turning& turning : plan.turnings) {
    near::Angles& start = starts.emplace_back();
    if (frames > 0) std::copy_n(given + turning.first, 3, start.begin());
  }
  near::turn_back(back.data(), frames, plan, starts);
  std::vector<std::size_t> found;
  for (const near::Turning& turning : plan.turnings) {
    std::size_t count = 0;
    for (std::size_t f = 0; f < frames; ++f) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t at = f * channels + turning.first + i;
        if (std::fabs(back[at] - given[at]) > (measure.radians ? 3.0 : 180.0)) ++count;
      }
    }
    found.push_back(count);
  }
  return found;
}

nb::bytes columns(std::vector<std::int64_t> apart, std::vector<std::int32_t> joints,
                  std::vector<std::int32_t> parents,
                  const std::vector<std::array<int, 5>>& turned) {
  RangeWriting side;
  std::vector<near::Turning> turnings = turnings_of(turned);
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
  near::code_columns(side, apart, told, turnings);
  return to_python(side.finish());
}

nb::bytes differences(std::vector<std::int64_t> apart) {
  RangeWriting side;
  near::code_differences(side, apart);
  return to_python(side.finish());
}

// What is being learned for the start of coders.
struct Learning {
  std::vector<near::Assumed> told;
  std::uint64_t observations;
  near::Start start;

  // Of each: channel, source, two shares; products as powers of 2^(1/4), and how far they are one.
  using Told = std::tuple<std::size_t, std::size_t, double, double, double, double, double>;

  Learning(const std::vector<Told>& all, std::uint64_t worth) : observations(worth) {
    for (const auto& [channel, source, share, other, moved, averaged, both] : all) {
      told.push_back({channel, source, {share, other}, moved, both, averaged});
    }
    const Bytes packed = pack_all();
    start = near::unpack(packed, true);
  }

  Bytes pack_all() const {
    near::Start whole = start;
    whole.assumed = told;
    whole.observations = observations;
    return near::pack(whole);
  }

  void learn(const near::Measure& measure, const near::Measure& curves,
             const Input<double, 2>& values, const nb::bytes& header, double scale, double rate) {
    const std::size_t frames = values.shape(0), channels = values.shape(1);
    near::Task task{near::read_header(view(header), channels), scale, rate, false,
                    std::vector(measure.points(channels), 1.0)};
    near::learn(start, values.data(), frames, task, measure, curves);
  }
};

std::pair<std::vector<int>, std::vector<std::array<int, 5>>> figure() {
  const near::Figure& known = near::known_figure();
  std::vector<std::array<int, 5>> turnings;
  for (const near::Turning& one : known.turnings) {
    turnings.push_back({static_cast<int>(one.first), one.columns, one.axes, one.curves, 0});
  }
  return {known.exponents, turnings};
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
             nb::arg("turnings"), "Code what columns have of their own, for the header.");
  module.def("near_differences", &differences, nb::arg("apart"),
             "Code a number for each column, 0 for most, for the header.");
  nb::class_<Learning>(module, "NearLearning", "Learns what coders of `near` begin with.")
      .def(
          nb::init<const std::vector<Learning::Told>&, std::uint64_t>(), nb::arg("assumed"),
          nb::arg("observations"),
          "Of each: channel, source, two shares, and the products of their features; and how many\n"
          "observations these are worth.")
      .def("learn", &Learning::learn, nb::arg("measure"), nb::arg("curves"), nb::arg("values"),
           nb::arg("header"), nb::arg("scale"), nb::arg("rate"), "Learn from rows.")
      .def(
          "pack", [](const Learning& own) { return to_python(own.pack_all()); },
          "Give what was learned, as it is shipped.");
  module.def("near_figure", &figure,
             "Give the known figure's exponents of steps, and its turnings.");
  module.def("near_turnable", &turnable, nb::arg("measure"), nb::arg("columns"),
             "Give the joints that end in three angles: first column, the orders of the file's\n"
             "columns and axes, and of the curves' axes, and whether angles are nearest to zero.");
  module.def("near_turned_measure", &turned_measure, nb::arg("measure"), nb::arg("turnings"),
             "Give the measure of channels as curves turn them.");
  module.def("near_turned", &turned_values, nb::arg("measure"), nb::arg("values"),
             nb::arg("turnings"), "Give the values by which curves turn.");
  module.def("near_unlike", &unlike, nb::arg("measure"), nb::arg("values"), nb::arg("turnings"),
             "Count for each turning the values that come back as other angles of the same turn.");
  module.def("near_encode", &encode, nb::arg("measure"), nb::arg("curves"), nb::arg("values"),
             nb::arg("header"), nb::arg("scale"), nb::arg("rate"), nb::arg("tries_knots"),
             nb::arg("weights"), nb::arg("most"), nb::arg("value_most"), nb::arg("kept"),
             nb::arg("rounds"),
             "Code rows as a chunk: its payload, the values that it decodes to, and the errors of\n"
             "joints, (F, J), or without a skeleton of values, (F, C).");
  module.def("near_decode", &decode, nb::arg("header"), nb::arg("payload"),
             nb::arg("values").noconvert(),
             "Fill ``values`` from a chunk; ValueError where it is none.");
}

}  // namespace mocapress
