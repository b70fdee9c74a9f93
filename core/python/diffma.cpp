#include <nanobind/stl/tuple.h>

#include <stdexcept>
#include <tuple>

#include "diffma/codec.hpp"
#include "python/bindings.hpp"

namespace mocapress {
namespace {

diffma::Parameters parameters_of(int bits, std::size_t window, double bound, int order) {
  if (bits < 1 || bits > diffma::kMostBits || window == 0 || !(bound > 0) || order < 0 ||
      order > diffma::kMostOrder) {
    throw std::invalid_argument("no such parameters");
  }
  return {bits, window, bound, order};
}

std::tuple<nb::bytes, Given<double>, double> encode(const Input<double, 1>& values, int bits,
                                                    std::size_t window, double bound, int order,
                                                    double tolerance, double round_offset,
                                                    double max_error, bool spare_signs) {
  const auto parameters = parameters_of(bits, window, bound, order);
  diffma::Record record;
  {
    const nb::gil_scoped_release unlocked;
    record = diffma::encode({values.data(), values.size()}, parameters,
                            {tolerance, round_offset, max_error, spare_signs});
  }
  return {nb::bytes(record.opcodes.data(), record.opcodes.size()), give(std::move(record.table)),
          record.squared_error};
}

// Steps, raws, fault and the character it stands at.
std::tuple<std::size_t, std::size_t, int, std::size_t> scan(const nb::bytes& opcodes, int bits) {
  if (bits < 1 || bits > diffma::kMostBits) throw std::invalid_argument("no such parameters");
  const auto found = diffma::scan(text_of(opcodes), bits);
  return {found.steps, found.raws, static_cast<int>(found.fault), found.fault_at};
}

void decode(const nb::bytes& opcodes, const Input<double, 1>& table,
            const Output<double, 1>& values, int bits, std::size_t window, double bound,
            int order) {
  const auto parameters = parameters_of(bits, window, bound, order);
  const auto text = text_of(opcodes);
  nb::gil_scoped_release unlocked;
  diffma::decode(text, {table.data(), table.size()}, parameters, {values.data(), values.size()});
}

}  // namespace

void bind_diffma(nb::module_& module) {
  const auto bits = nb::arg("bits");
  const auto window = nb::arg("window");
  const auto bound = nb::arg("bound");
  const auto order = nb::arg("order");
  module.def("diffma_encode", &encode, nb::arg("values"), bits, window, bound, order,
             nb::arg("tolerance"), nb::arg("round_offset"), nb::arg("max_error"),
             nb::arg("spare_signs"),
             "Give one channel as opcodes and a look-up table, and the sum of squared errors.");
  module.def("diffma_scan", &scan, nb::arg("opcodes"), bits,
             "Give how many steps and raw numbers opcodes ask for; a fault, and where it is.\n\n"
             "Faults: core/diffma/codec.hpp; 0 is none.");
  module.def("diffma_decode", &decode, nb::arg("opcodes"), nb::arg("table"),
             nb::arg("values").noconvert(), bits, window, bound, order,
             "Fill ``values``; ValueError where opcodes, table and their number do not agree.");
}

}  // namespace mocapress
