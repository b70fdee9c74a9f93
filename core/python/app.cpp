#include <nanobind/stl/vector.h>

#include <stdexcept>

#include "app/codec.hpp"
#include "coding/numbers.hpp"
#include "coding/sides.hpp"
#include "python/bindings.hpp"
#include "python/float_columns.hpp"

namespace mocapress {
namespace {

app::Parameters parameters_of(const Input<double, 1>& alphas, std::size_t cluster,
                              int mantissa_limit) {
  const std::size_t size = alphas.shape(0);
  if (size == 0 || size > 256 || (size & (size - 1)) != 0 || cluster == 0) {
    throw std::invalid_argument("no table of 2^k alphas, k <= 8, or clusters of no frames");
  }
  return {{alphas.data(), size}, cluster, mantissa_limit};
}

nb::bytes encode(const Input<double, 2>& values, const FloatPlan& plan,
                 const Input<double, 1>& alphas, std::size_t cluster, int mantissa_limit) {
  const auto columns = float_columns(plan, values.shape(1));
  const auto parameters = parameters_of(alphas, cluster, mantissa_limit);
  Bytes payload;
  {
    nb::gil_scoped_release unlocked;
    payload = app::encode(values.data(), values.shape(0), columns, parameters);
  }
  return to_python(payload);
}

void decode(const nb::bytes& payload, const Output<double, 2>& values, const FloatPlan& plan,
            const Input<double, 1>& alphas, std::size_t cluster, int mantissa_limit) {
  const auto columns = float_columns(plan, values.shape(1));
  const auto parameters = parameters_of(alphas, cluster, mantissa_limit);
  const ByteView bytes = view(payload);
  nb::gil_scoped_release unlocked;
  app::decode(bytes, values.data(), values.shape(0), columns, parameters);
}

std::vector<int> precisions(const Input<double, 2>& values, const FloatPlan& plan) {
  const auto columns = float_columns(plan, values.shape(1));
  std::vector<int> found;
  nb::gil_scoped_release unlocked;
  for (const auto precision : app::precisions(values.data(), values.shape(0), columns)) {
    found.push_back(static_cast<int>(precision));
  }
  return found;
}

std::vector<double> ideal_alphas(const Input<double, 2>& values, const FloatPlan& plan,
                                 std::size_t cluster) {
  const auto columns = float_columns(plan, values.shape(1));
  if (cluster == 0) throw std::invalid_argument("clusters of no frames");
  nb::gil_scoped_release unlocked;
  return app::ideal_alphas(values.data(), values.shape(0), columns, cluster);
}

double prediction_error(const Input<double, 2>& values, const FloatPlan& plan,
                        const Input<double, 1>& alphas, std::size_t cluster) {
  const auto columns = float_columns(plan, values.shape(1));
  const auto parameters = parameters_of(alphas, cluster, 0);
  nb::gil_scoped_release unlocked;
  return app::prediction_error(values.data(), values.shape(0), columns, parameters);
}

void snap_columns(const Output<double, 2>& values, const FloatPlan& plan) {
  const auto columns = float_columns(plan, values.shape(1));
  nb::gil_scoped_release unlocked;
  std::vector<NumberLine> lines;
  for (const auto& column : columns) lines.emplace_back(column.line, column.digits);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values.data()[i] = lines[i % lines.size()].nearest(values.data()[i]);
  }
}

nb::bytes encode_differences(const Input<std::int64_t, 1>& differences) {
  Bytes coded;
  {
    nb::gil_scoped_release unlocked;
    RangeWriting side;
    Difference<7> difference;
    for (std::size_t i = 0; i < differences.size(); ++i) {
      difference.code(side, differences.data()[i]);
    }
    coded = side.finish();
  }
  return to_python(coded);
}

void decode_differences(const nb::bytes& coded, const Output<std::int64_t, 1>& differences) {
  RangeReading side(view(coded));
  nb::gil_scoped_release unlocked;
  Difference<7> difference;
  for (std::size_t i = 0; i < differences.size() && side.sound(); ++i) {
    differences.data()[i] = difference.code(side, 0);
  }
  if (!side.exhausted()) throw std::invalid_argument("the differences are cut off or too long");
}

}  // namespace

void bind_app(nb::module_& module) {
  const auto values = nb::arg("values");
  const auto plan = nb::arg("plan");
  const auto alphas = nb::arg("alphas");
  const auto cluster = nb::arg("cluster");
  const auto mantissa_limit = nb::arg("mantissa_limit");
  const auto filled = nb::arg("values").noconvert();
  module.def("app_precisions", &precisions, values, plan,
             "Give the most compact precision of each column that keeps all its values.\n\n"
             "A plan has parent column or -1, precision, line and digits of each column: see\n"
             "core/app/codec.hpp and core/numbers/line.hpp.");
  module.def("app_encode", &encode, values, plan, alphas, cluster, mantissa_limit,
             "Code rows of values as a chunk; ``cluster`` in frames.");
  module.def("app_decode", &decode, nb::arg("payload"), filled, plan, alphas, cluster,
             mantissa_limit, "Fill ``values`` from a chunk; ValueError where it is none.");
  module.def("app_ideal_alphas", &ideal_alphas, values, plan, cluster,
             "Give the alpha of least squared error of each cluster and column, row by row.");
  module.def("app_prediction_error", &prediction_error, values, plan, alphas, cluster,
             "Give the sum of what the values differ from their predictions by.");
  module.def("snap", &snap_columns, filled, plan,
             "Move values to the nearest numbers of their columns' lines, in place.");
  module.def("encode_differences", &encode_differences, nb::arg("differences"),
             "Code whole numbers, most of them small.");
  module.def("decode_differences", &decode_differences, nb::arg("coded"),
             nb::arg("differences").noconvert(),
             "Fill ``differences``; ValueError where ``coded`` is not so many.");
}

}  // namespace mocapress
