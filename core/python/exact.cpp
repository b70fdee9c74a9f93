#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "exact/codec.hpp"
#include "exact/expert.hpp"
#include "exact/header.hpp"
#include "exact/joint.hpp"
#include "exact/kinematics.hpp"
#include "exact/law.hpp"
#include "exact/network.hpp"
#include "numbers/coarsest_line.hpp"
#include "python/bindings.hpp"

namespace mocapress {
namespace {

// Line, digits, noise, exponent, turns, place.
using ExactPlan = Plan<std::int32_t, 6>;
// Kind, sources, targets, parameters.
using Couplings = std::vector<
    std::tuple<int, std::vector<std::uint16_t>, std::vector<std::uint16_t>, std::vector<double>>>;

std::vector<exact::Column> columns_of(const ExactPlan& plan, std::size_t count) {
  if (plan.shape(0) != count) throw std::invalid_argument("the plan is not for these columns");
  std::vector<exact::Column> columns(count);
  for (std::size_t c = 0; c < count; ++c) {
    const std::int32_t* row = plan.data() + 6 * c;
    if (!line_exists(row[0], row[1])) throw std::invalid_argument("a line of unknown kind");
    columns[c] = {static_cast<Line>(row[0]), row[1], row[2] != 0, row[3], row[4], row[5]};
  }
  return columns;
}

bool has_shape(int kind, std::size_t sources, std::size_t targets,
               const std::vector<double>& parameters) {
  if (kind == exact::Joint::kKind) return targets == 1 && exact::Joint::exists(sources, parameters);
  if (kind < 0 || kind > static_cast<int>(exact::LawKind::neck_middle)) return false;
  const auto law = static_cast<exact::LawKind>(kind);
  return kind == 0 || (sources == exact::Law::sources(law) && targets == exact::Law::targets(law));
}

// The compiled coder relies on what is checked here.
std::vector<exact::Coupling> couplings_of(const Couplings& told,
                                          const std::vector<exact::Column>& columns) {
  constexpr std::size_t most = 16;
  std::vector<exact::Coupling> couplings;
  std::vector<bool> taken(columns.size());
  for (const auto& [kind, sources, targets, parameters] : told) {
    if (sources.empty() || targets.empty() || sources.size() > most || targets.size() > most ||
        !has_shape(kind, sources.size(), targets.size(), parameters)) {
      throw std::invalid_argument("a coupling of unknown shape");
    }
    for (const auto column : sources) {
      if (column >= targets.front()) throw std::invalid_argument("a coupling to later columns");
    }
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (targets[i] >= columns.size() || columns[targets[i]].noise || taken[targets[i]] ||
          (i > 0 && targets[i] <= targets[i - 1])) {
        throw std::invalid_argument("a coupling of columns that are not there");
      }
      if (kind != 0) taken[targets[i]] = true;
    }
    couplings.push_back({kind, sources, targets, parameters});
  }
  return couplings;
}

// The arguments that say how a clip is coded, and what they refer to.
struct Told {
  Told(const ExactPlan& plan, std::size_t count, const Couplings& told, int level,
       exact::Start start)
      : columns(columns_of(plan, count)),
        couplings(couplings_of(told, columns)),
        start(checked(std::move(start))),
        clip{columns, couplings, level, this->start} {}

  Told(const Told&) = delete;

  static exact::Start checked(exact::Start start) {
    const auto unusable = [](float value) { return !(std::fabs(value) < 1e30f); };
    bool found = std::ranges::any_of(start.shared, unusable);
    for (const auto& column : start.columns) found |= std::ranges::any_of(column, unusable);
    if (found) throw std::invalid_argument("a start of numbers that were not learned");
    return start;
  }

  std::vector<exact::Column> columns;
  std::vector<exact::Coupling> couplings;
  exact::Start start;
  exact::Clip clip;
};

using Learned = std::pair<std::vector<float>, std::vector<std::vector<float>>>;

std::tuple<nb::bytes, Learned, std::size_t> encode(const Input<double, 2>& values,
                                                   const ExactPlan& plan,
                                                   const Couplings& couplings, int level,
                                                   Learned start, bool learn) {
  const Told arguments(plan, values.shape(1), couplings, level,
                       {std::move(start.first), std::move(start.second)});
  Bytes payload;
  exact::Start learned;
  std::size_t early = 0;
  {
    nb::gil_scoped_release unlocked;
    payload = exact::encode(values.data(), values.shape(0), arguments.clip,
                            learn ? &learned : nullptr, nullptr, &early);
  }
  return {to_python(payload), {std::move(learned.shared), std::move(learned.columns)}, early};
}

void decode(const nb::bytes& payload, const Output<double, 2>& values, const ExactPlan& plan,
            const Couplings& couplings, int level, Learned start, bool whole) {
  const Told arguments(plan, values.shape(1), couplings, level,
                       {std::move(start.first), std::move(start.second)});
  const ByteView bytes = view(payload);
  nb::gil_scoped_release unlocked;
  exact::decode(bytes, values.data(), values.shape(0), arguments.clip, whole);
}

// How many columns chunks hold, and whether a model is needed.
std::pair<std::size_t, bool> coded(const nb::bytes& header, std::size_t columns) {
  const auto read = exact::read_header(view(header), columns);
  return {read.coded.size(), read.has_model};
}

void decode_chunk(const nb::bytes& header, const nb::bytes& payload,
                  const Output<double, 2>& values, std::size_t frames, int level,
                  const nb::bytes& model) {
  const std::size_t wanted = values.shape(0), columns = values.shape(1);
  if (wanted > frames) throw std::invalid_argument("more frames than the chunk has");
  const ByteView bytes = view(payload), learned = view(model), head = view(header);
  nb::gil_scoped_release unlocked;
  const auto read = exact::read_header(head, columns);
  const auto start = learned.empty() ? exact::Start{} : exact::read_start(learned, read);
  exact::decode(bytes, values.data(), frames, wanted, columns, read, level, start);
}

// What the network sees of each number, and what would have been right, (n, inputs + 1).
Given<float, 2> network_inputs(const Input<double, 2>& values, const ExactPlan& plan,
                               const Couplings& couplings, int level) {
  const Told arguments(plan, values.shape(1), couplings, level, {});
  std::vector<float> seen;
  exact::encode(values.data(), values.shape(0), arguments.clip, nullptr, &seen);
  constexpr std::size_t columns = exact::Network::kInputs + 1;
  const std::size_t rows = seen.size() / columns;
  return give(std::move(seen), std::array{rows, columns});
}

std::vector<std::pair<int, int>> lines(const Input<double, 2>& values) {
  std::vector<std::pair<int, int>> found;
  nb::gil_scoped_release unlocked;
  for (const auto& line : coarsest_lines(values.data(), values.shape(0), values.shape(1))) {
    found.emplace_back(static_cast<int>(line.line), line.digits);
  }
  return found;
}

// What a law has for the targets, (F, T) degrees, where they are known; `columns` are sources,
// targets.
Given<double, 2> law(int kind, const Input<double, 2>& columns) {
  if (kind < 1 || kind > static_cast<int>(exact::LawKind::neck_middle) ||
      kind == exact::Joint::kKind) {
    throw std::invalid_argument("a law of unknown kind");
  }
  const auto named = static_cast<exact::LawKind>(kind);
  const std::size_t sources = exact::Law::sources(named);
  const std::size_t targets = exact::Law::targets(named);
  if (columns.shape(1) != sources + targets) {
    throw std::invalid_argument("not the columns of this law");
  }
  const std::size_t rows = columns.shape(0);
  std::vector<double> told(rows * targets);
  exact::Law found(named);
  for (std::size_t row = 0; row < rows; ++row) {
    const double* angles = columns.data() + row * columns.shape(1);
    found.begin(angles);
    for (std::size_t t = 0; t < targets; ++t) {
      told[row * targets + t] = found.predict(t, angles + sources);
    }
  }
  return give(std::move(told), std::array{rows, targets});
}

// The second differences, (F, C), that the skeleton's geometry has for channels at these places of
// it, where the rows before each, and the channels before it in its own, are known; before the
// first row it was as it is there.
Given<double, 2> guesses(const Input<double, 2>& values, const std::vector<int>& places) {
  const std::size_t count = values.shape(1);
  if (places.size() != count) throw std::invalid_argument("not one place per column");
  std::vector<exact::Column> columns;
  for (const int place : places) columns.push_back({Line::float64, 0, false, 0, 0, place});
  exact::Kinematics kinematics(columns);
  exact::Frames frames(count);
  const std::size_t rows = values.shape(0);
  std::vector<double> told(rows * count);
  for (std::size_t row = 0; row < rows; ++row) {
    const double* numbers = values.data() + row * count;
    for (int age = 0; row == 0 && age < exact::Frames::kKept; ++age) {
      frames.next();
      for (std::size_t c = 0; c < count; ++c) frames.set(c, numbers[c]);
    }
    frames.next();
    kinematics.begin(frames);
    for (std::size_t c = 0; c < count; ++c) {
      told[row * count + c] = kinematics.guess(c, frames);
      frames.set(c, numbers[c]);
    }
  }
  return give(std::move(told), std::array{rows, count});
}

}  // namespace

void bind_exact(nb::module_& module) {
  const auto values = nb::arg("values");
  const auto plan = nb::arg("plan");
  const auto couplings = nb::arg("couplings");
  const auto level = nb::arg("level");
  const auto start = nb::arg("start");
  module.def(
      "exact_encode", &encode, values, plan, couplings, level, start, nb::arg("learn"),
      "Code rows of values as a chunk; give what was learned, too, where ``learn``.\n\n"
      "Last comes about how many bytes the first 256 rows take, where the level is above 5.\n\n"
      "A plan has line, digits, noise, exponent, turns and place of each column, a coupling\n"
      "kind, sources, targets and parameters: see core/exact/codec.hpp.");
  module.def("exact_decode", &decode, nb::arg("payload"), nb::arg("values").noconvert(), plan,
             couplings, level, start, nb::arg("whole"),
             "Fill ``values`` from a chunk; ValueError where it is none.\n\n"
             "Unless ``whole``, these are only the chunk's first frames.");
  module.def("exact_coded", &coded, nb::arg("header"), nb::arg("columns"),
             "Give how many columns chunks hold, and whether their clip was coded with a model.\n\n"
             "ValueError where the bytes are no codec header of a clip of so many columns.");
  module.def("exact_decode_chunk", &decode_chunk, nb::arg("header"), nb::arg("payload"),
             nb::arg("values").noconvert(), nb::arg("frames"), nb::arg("level"), nb::arg("model"),
             "Fill ``values``, all columns of a clip, with the first frames of a chunk.\n\n"
             "``frames`` are those of the chunk, ``model`` a model's payload or nothing.\n"
             "ValueError where header, payload or model are none.");
  module.def("exact_network_inputs", &network_inputs, values, plan, couplings, level,
             "Give what the network sees of each number, and what would have been right.\n\n"
             "A row for each number that it takes part in, (n, inputs + 1), in units of how far\n"
             "off the number was to be expected.");
  module.def("exact_lines", &lines, values,
             "Give the coarsest line that holds each column, and its digits.");
  module.def(
      "exact_law", &law, nb::arg("kind"), nb::arg("columns"),
      "Give what a law has for its targets, (F, T) degrees, where those before are known.\n\n"
      "The columns are those of its sources and targets, in degrees.");
  module.def("exact_guesses", &guesses, values, nb::arg("places"),
             "Give the second differences that the skeleton's geometry has, (F, C).\n\n"
             "The channels are at these places of the skeleton; the rows before each, and the\n"
             "channels before it in its own, are known.");
}

}  // namespace mocapress
