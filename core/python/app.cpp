#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>

#include "app/codec.hpp"
#include "coding/numbers.hpp"
#include "coding/sides.hpp"
#include "python/bindings.hpp"

namespace mocapress {
namespace {

namespace nb = nanobind;

using Matrix = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Output = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Integers = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using IntegerOutput = nb::ndarray<std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
// (C, 4): parent, precision, line, digits
using Plan = nb::ndarray<const std::int32_t, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;

std::vector<app::Column> columns_of(const Plan& plan, std::size_t count) {
  if (plan.shape(0) != count) throw std::invalid_argument("the plan is not for these columns");
  std::vector<app::Column> columns(count);
  for (std::size_t c = 0; c < count; ++c) {
    const std::int32_t* row = plan.data() + 4 * c;
    const Line line = line_exists(row[2], row[3]) ? static_cast<Line>(row[2]) : Line::float64;
    columns[c] = {row[0], static_cast<app::Precision>(row[1]), line, row[3]};
  }
  return columns;
}

app::Parameters parameters_of(const Table& alphas, std::size_t cluster, int mantissa_limit) {
  const std::size_t size = alphas.shape(0);
  if (size == 0 || size > 256 || (size & (size - 1)) != 0 || cluster == 0) {
    throw std::invalid_argument("no table of 2^k alphas, k <= 8, or clusters of no frames");
  }
  return {{alphas.data(), size}, cluster, mantissa_limit};
}

nb::bytes to_python(const Bytes& bytes) { return nb::bytes(bytes.data(), bytes.size()); }

ByteView view(const nb::bytes& bytes) {
  return {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

nb::bytes encode(const Matrix& values, const Plan& plan, const Table& alphas, std::size_t cluster,
                 int mantissa_limit) {
  const auto columns = columns_of(plan, values.shape(1));
  const auto parameters = parameters_of(alphas, cluster, mantissa_limit);
  Bytes payload;
  {
    nb::gil_scoped_release unlocked;
    payload = app::encode(values.data(), values.shape(0), columns, parameters);
  }
  return to_python(payload);
}

void decode(const nb::bytes& payload, const Output& values, const Plan& plan, const Table& alphas,
            std::size_t cluster, int mantissa_limit) {
  const auto columns = columns_of(plan, values.shape(1));
  const auto parameters = parameters_of(alphas, cluster, mantissa_limit);
  const ByteView bytes = view(payload);
  nb::gil_scoped_release unlocked;
  app::decode(bytes, values.data(), values.shape(0), columns, parameters);
}

std::vector<int> precisions(const Matrix& values, const Plan& plan) {
  const auto columns = columns_of(plan, values.shape(1));
  std::vector<int> found;
  nb::gil_scoped_release unlocked;
  for (const auto precision : app::precisions(values.data(), values.shape(0), columns)) {
    found.push_back(static_cast<int>(precision));
  }
  return found;
}

std::vector<double> ideal_alphas(const Matrix& values, const Plan& plan, std::size_t cluster) {
  const auto columns = columns_of(plan, values.shape(1));
  if (cluster == 0) throw std::invalid_argument("clusters of no frames");
  nb::gil_scoped_release unlocked;
  return app::ideal_alphas(values.data(), values.shape(0), columns, cluster);
}

double prediction_error(const Matrix& values, const Plan& plan, const Table& alphas,
                        std::size_t cluster) {
  const auto columns = columns_of(plan, values.shape(1));
  const auto parameters = parameters_of(alphas, cluster, 0);
  nb::gil_scoped_release unlocked;
  return app::prediction_error(values.data(), values.shape(0), columns, parameters);
}

void snap_columns(const Output& values, const Plan& plan) {
  const auto columns = columns_of(plan, values.shape(1));
  nb::gil_scoped_release unlocked;
  std::vector<NumberLine> lines;
  for (const auto& column : columns) lines.emplace_back(column.line, column.digits);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values.data()[i] = lines[i % lines.size()].nearest(values.data()[i]);
  }
}

nb::bytes encode_differences(const Integers& differences) {
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

void decode_differences(const nb::bytes& coded, const IntegerOutput& differences) {
  RangeReading side(view(coded));
  nb::gil_scoped_release unlocked;
  Difference<7> difference;
  for (std::size_t i = 0; i < differences.size() && side.sound(); ++i) {
    differences.data()[i] = difference.code(side, 0);
  }
  if (!side.exhausted()) throw std::invalid_argument("the differences are cut off or too long");
}

}  // namespace

void bind_app(nanobind::module_& module) {
  module.def("app_precisions", &precisions, nb::arg("values"), nb::arg("plan"));
  module.def("app_encode", &encode, nb::arg("values"), nb::arg("plan"), nb::arg("alphas"),
             nb::arg("cluster"), nb::arg("mantissa_limit"));
  module.def("app_decode", &decode, nb::arg("payload"), nb::arg("values"), nb::arg("plan"),
             nb::arg("alphas"), nb::arg("cluster"), nb::arg("mantissa_limit"));
  module.def("app_ideal_alphas", &ideal_alphas, nb::arg("values"), nb::arg("plan"),
             nb::arg("cluster"));
  module.def("app_prediction_error", &prediction_error, nb::arg("values"), nb::arg("plan"),
             nb::arg("alphas"), nb::arg("cluster"));
  module.def("snap", &snap_columns, nb::arg("values"), nb::arg("plan"));
  module.def("encode_differences", &encode_differences, nb::arg("differences"));
  module.def("decode_differences", &decode_differences, nb::arg("coded"), nb::arg("differences"));
}

}  // namespace mocapress
