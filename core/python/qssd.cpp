// Python's view of the codec `qssd`.
#include <utility>

#include "python/bindings.hpp"
#include "qssd/codec.hpp"
#include "qssd_learning/encoder.hpp"
#include "qssd_learning/sparse.hpp"

namespace mocapress {
namespace {

qssd::Plan plan_of(const nb::bytes& header, const nb::bytes& model, std::size_t columns) {
  return qssd::read_plan(view(header), view(model), columns);
}

qssd::Effort effort_of(std::size_t most, double rounding, double rest_rounding) {
  if (most < 1 || most > qssd::kMostAtoms) throw nb::value_error("no such number of atoms");
  return {most, rounding, rest_rounding};
}

nb::bytes encode(const Input<double, 2>& values, const nb::bytes& header, const nb::bytes& model,
                 std::size_t most, double rounding, double rest_rounding,
                 const Input<double, 2>& max_errors) {
  const auto plan = plan_of(header, model, values.shape(1));
  const auto effort = effort_of(most, rounding, rest_rounding);
  if (max_errors.shape(0) != values.shape(0) || max_errors.shape(1) != values.shape(1)) {
    throw nb::value_error("limits of errors that are not as many as values");
  }
  Bytes payload;
  {
    const nb::gil_scoped_release release;
    payload = qssd::encode_chunk(values.data(), values.shape(0), plan, effort, max_errors.data());
  }
  return to_python(payload);
}

void decode(const nb::bytes& payload, const Output<double, 2>& values, const nb::bytes& header,
            const nb::bytes& model) {
  const auto plan = plan_of(header, model, values.shape(1));
  const ByteView coded = view(payload);
  const nb::gil_scoped_release release;
  qssd::decode(coded, values.data(), values.shape(0), plan);
}

Given<std::int64_t, 2> symbols(const Input<double, 2>& values, const nb::bytes& header,
                               const nb::bytes& model, std::size_t most, double rounding,
                               double rest_rounding) {
  const auto plan = plan_of(header, model, values.shape(1));
  const auto effort = effort_of(most, rounding, rest_rounding);
  std::vector<std::int64_t> found;
  {
    const nb::gil_scoped_release release;
    found = qssd::symbols_of(values.data(), values.shape(0), plan, effort);
  }
  const std::size_t size = plan.atoms + plan.body.columns;
  const std::array shape{size == 0 ? 0 : found.size() / size, size};
  return give(std::move(found), shape);
}

Given<std::size_t, 1> kinds(std::size_t frames, const nb::bytes& header, std::size_t columns,
                            const nb::bytes& model) {
  return give(qssd::kinds_of(frames, plan_of(header, model, columns)));
}

Given<double, 3> displacements(const Input<double, 2>& values, const nb::bytes& header) {
  const auto plan = plan_of(header, nb::bytes("", 0), values.shape(1));
  const auto found = qssd::displacements(values.data(), values.shape(0), plan);
  std::vector<double> flat;
  for (const auto& turn : found) flat.insert(flat.end(), turn.begin(), turn.end());
  const std::size_t joints = plan.body.joints.size();
  return give(std::move(flat),
              std::array{joints == 0 ? 0 : found.size() / joints, joints, std::size_t{4}});
}

Given<double, 3> turns(const Input<double, 2>& values, const nb::bytes& header) {
  const auto plan = plan_of(header, nb::bytes("", 0), values.shape(1));
  const std::size_t frames = values.shape(0), joints = plan.body.joints.size();
  const auto pose = qssd::pose_of(values.data(), frames, plan);
  std::vector<double> flat;
  for (const auto& turn : pose.turns) flat.insert(flat.end(), turn.begin(), turn.end());
  return give(std::move(flat), std::array{frames, joints, std::size_t{4}});
}

}  // namespace

void bind_qssd(nb::module_& module) {
  const auto values = nb::arg("values");
  const auto header = nb::arg("header");
  const auto model = nb::arg("model");
  const auto most = nb::arg("most");
  const auto rounding = nb::arg("rounding");
  const auto rest_rounding = nb::arg("rest_rounding");
  module.def("qssd_encode", &encode, values, header, model, most, rounding, rest_rounding,
             nb::arg("max_errors"),
             "Code rows of values as a chunk: core/qssd_learning/encoder.hpp.");
  module.def("qssd_decode", &decode, nb::arg("payload"), values.noconvert(), header, model,
             "Fill ``values`` from a chunk; ValueError where it is none.");
  module.def("qssd_symbols", &symbols, values, header, model, most, rounding, rest_rounding,
             "Give what rows are coded as, (samples, atoms + columns).");
  module.def("qssd_kinds", &kinds, nb::arg("frames"), header, nb::arg("columns"), model,
             "Give the kinds of the stages of the samples.");
  module.def("qssd_turns", &turns, values, header, "Give the turns of joints, (F, J, 4).");
  module.def("qssd_displacements", &displacements, values, header,
             "Give what frames turn by from their predictions, (samples, J, 4).");
}

}  // namespace mocapress
