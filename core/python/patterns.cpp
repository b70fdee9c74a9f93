// Python's view of the codec `patterns`.
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>
#include <utility>

#include "patterns/codec.hpp"
#include "python/bindings.hpp"

namespace mocapress {
namespace {

namespace pt = patterns;
using Numbers = Input<std::int64_t, 1>;

// Parts of an array that stand one behind the other.
template <class Array>
class Taken {
 public:
  explicit Taken(const Array& all) : all_(all) {}

  auto operator()(std::size_t count) {
    if (count > all_.size() - at_) throw nb::value_error("fewer numbers than a database needs");
    const auto* const first = all_.data() + at_;
    at_ += count;
    return std::pair(first, first + count);
  }

 private:
  const Array& all_;
  std::size_t at_ = 0;
};

template <class Element, class Array>
std::vector<Element> taken(Taken<Array>& from, std::size_t count) {
  const auto [first, last] = from(count);
  return {first, last};
}

nb::bytes database(const nb::bytes& body, std::size_t columns, const Numbers& bases,
                   const Numbers& centres, const Numbers& terms,
                   const Input<std::uint8_t, 1>& differences, const Input<float, 1>& quantisers) {
  auto plan = pt::read_body_alone(view(body), columns);
  Taken of_bases(bases), of_centres(centres), of_terms(terms);
  Taken of_differences(differences);
  Taken of_quantisers(quantisers);
  for (pt::Node& node : plan.nodes) {
    const std::size_t size = node.columns.size(), series = node.patterns * node.components;
    if (plan.published) {
      node.first = taken<std::int64_t>(of_terms, series);
      node.differences = taken<std::uint8_t>(of_differences, series * (node.frames - 1));
      node.quantisers = taken<float>(of_quantisers, 2 * node.patterns);
      continue;
    }
    node.basis = taken<std::int64_t>(of_bases, node.components * size);
    node.centre = taken<std::int64_t>(of_centres, size);
    node.starts.assign(1, 0);
    for (std::size_t s = 0; s < series; ++s) {
      auto own = taken<std::int64_t>(of_terms, node.frames);
      while (!own.empty() && own.back() == 0) own.pop_back();
      node.terms.insert(node.terms.end(), own.begin(), own.end());
      node.starts.push_back(static_cast<std::uint32_t>(node.terms.size()));
    }
  }
  return to_python(pt::write_database(plan));
}

// Shapes of all patterns of a node, (patterns, frames, components).
Given<double, 3> shapes(const nb::bytes& header, const nb::bytes& model, std::size_t columns,
                        std::size_t node) {
  const auto plan = pt::read_plan(view(header), view(model), columns);
  if (node >= plan.nodes.size()) throw nb::value_error("no such node");
  const pt::Node& own = plan.nodes[node];
  std::vector<double> found(own.patterns * own.frames * own.components);
  for (std::size_t p = 0; p < own.patterns; ++p) {
    pt::shape_of(plan, node, p, found.data() + p * own.frames * own.components);
  }
  return give(std::move(found), std::array{own.patterns, own.frames, own.components});
}

// Of each node its frames, components, importance, basis (components, columns) and centre.
using Facts = std::tuple<std::size_t, std::size_t, double, Given<double>, Given<double>>;
std::vector<Facts> nodes(const nb::bytes& header, const nb::bytes& model, std::size_t columns) {
  const auto plan = pt::read_plan(view(header), view(model), columns);
  std::vector<Facts> found;
  for (const pt::Node& node : plan.nodes) {
    std::vector<double> basis, centre;
    for (const auto step : node.basis) basis.push_back(static_cast<double>(step) / pt::kBasisSteps);
    for (const auto step : node.centre) centre.push_back(static_cast<double>(step) * plan.pattern);
    found.emplace_back(node.frames, node.components, node.importance, give(std::move(basis)),
                       give(std::move(centre)));
  }
  return found;
}

// `segments`: for each node how many, then of each its frames and its pattern.
std::vector<pt::Segments> segments_of(const Numbers& told, const pt::Plan& plan,
                                      std::size_t frames) {
  std::vector<pt::Segments> found(plan.nodes.size());
  Taken next(told);
  for (std::size_t n = 0; n < found.size(); ++n) {
    const auto count = static_cast<std::size_t>(*next(1).first);
    std::size_t sum = 0;
    for (std::size_t s = 0; s < count; ++s) {
      const auto* const pair = next(2).first;
      if (pair[0] < 1 || pair[1] < 0) throw nb::value_error("a segment that is none");
      found[n].frames.push_back(static_cast<std::size_t>(pair[0]));
      found[n].patterns.push_back(static_cast<std::size_t>(pair[1]));
      sum += found[n].frames.back();
    }
    if (sum != frames) throw nb::value_error("segments that are not all frames");
  }
  return found;
}

nb::bytes encode(const Input<double, 2>& values, const Input<double, 2>& filled,
                 const Input<std::uint8_t, 2>& kept, const nb::bytes& header,
                 const nb::bytes& model, const Numbers& told, const Input<double, 1>& projections,
                 double max_error, double protected_error) {
  const std::size_t frames = values.shape(0), columns = values.shape(1);
  const auto plan = pt::read_plan(view(header), view(model), columns);
  const auto segments = segments_of(told, plan, frames);
  std::size_t size = 0;
  for (const pt::Node& node : plan.nodes) size += node.components * node.columns.size();
  if (filled.shape(0) != frames || filled.shape(1) != columns || kept.shape(0) != frames ||
      kept.shape(1) != columns || projections.size() != size) {
    throw nb::value_error("arrays of other shapes");
  }
  const pt::Given given = {
      values.data(), filled.data(),  kept.data(), segments, {projections.data(), size},
      max_error,     protected_error};
  Bytes payload;
  {
    const nb::gil_scoped_release release;
    payload = pt::encode(given, frames, plan);
  }
  return to_python(payload);
}

void decode(const nb::bytes& payload, const Output<double, 2>& values, const nb::bytes& header,
            const nb::bytes& model) {
  const auto plan = pt::read_plan(view(header), view(model), values.shape(1));
  const ByteView coded = view(payload);
  const nb::gil_scoped_release release;
  pt::decode(coded, values.data(), values.shape(0), plan);
}

std::array<double, pt::kParts> bits(const nb::bytes& payload, std::size_t frames,
                                    std::size_t columns, const nb::bytes& header,
                                    const nb::bytes& model) {
  const auto plan = pt::read_plan(view(header), view(model), columns);
  return pt::bits_of(view(payload), frames, plan);
}

}  // namespace

void bind_patterns(nb::module_& module) {
  const auto header = nb::arg("header");
  const auto model = nb::arg("model");
  const auto columns = nb::arg("columns");
  module.def("patterns_database", &database, nb::arg("body"), columns, nb::arg("bases"),
             nb::arg("centres"), nb::arg("terms"), nb::arg("differences"), nb::arg("quantisers"),
             "Code the database that ends a body: core/patterns/plan.hpp.");
  module.def("patterns_shapes", &shapes, header, model, columns, nb::arg("node"),
             "Give a node's patterns, (patterns, frames, components).");
  module.def("patterns_nodes", &nodes, header, model, columns,
             "Give of each node its frames, components, importance, basis and centre.");
  module.def("patterns_encode", &encode, nb::arg("values"), nb::arg("filled"), nb::arg("kept"),
             header, model, nb::arg("segments"), nb::arg("projections"), nb::arg("max_error"),
             nb::arg("protected_error"),
             "Code rows of values as a chunk: core/patterns/codec.hpp.");
  module.def("patterns_decode", &decode, nb::arg("payload"), nb::arg("values").noconvert(), header,
             model, "Fill ``values`` from a chunk; ValueError where it is none.");
  module.def("patterns_bits", &bits, nb::arg("payload"), nb::arg("frames"), columns, header, model,
             "Give the bits of a chunk's root and protected columns, of its segments' lengths, "
             "patterns and places, and of its corrections.");
}

}  // namespace mocapress
