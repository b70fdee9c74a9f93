#include <nanobind/ndarray.h>
#include <nanobind/stl/tuple.h>

#include <stdexcept>
#include <tuple>

#include "diffma/codec.hpp"
#include "python/bindings.hpp"

namespace mocapress {
namespace {

namespace nb = nanobind;

using Values = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Output = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Table = nb::ndarray<nb::numpy, double, nb::ndim<1>>;

diffma::Parameters parameters_of(int bits, std::size_t window, double bound, int order) {
  if (bits < 1 || bits > diffma::most_bits || window == 0 || !(bound > 0) || order < 0 ||
      order > diffma::most_order) {
    throw std::invalid_argument("no such parameters");
  }
  return {bits, window, bound, order};
}

std::string_view view(const nb::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }

std::tuple<nb::bytes, Table, double> encode(const Values& values, int bits, std::size_t window,
                                            double bound, int order, double tolerance,
                                            double round_offset, double max_error,
                                            bool spare_signs) {
  const auto parameters = parameters_of(bits, window, bound, order);
  // Moved to the heap, where NumPy keeps it as long as it needs it.
  auto* record = new diffma::Record;
  nb::capsule owner(record, [](void* p) noexcept { delete static_cast<diffma::Record*>(p); });
  {
    nb::gil_scoped_release unlocked;
    *record = diffma::encode({values.data(), values.size()}, parameters,
                             {tolerance, round_offset, max_error, spare_signs});
  }
  return {nb::bytes(record->opcodes.data(), record->opcodes.size()),
          Table(record->table.data(), {record->table.size()}, owner), record->squared_error};
}

// Steps, raws, fault and the character it stands at.
std::tuple<std::size_t, std::size_t, int, std::size_t> scan(const nb::bytes& opcodes, int bits) {
  if (bits < 1 || bits > diffma::most_bits) throw std::invalid_argument("no such parameters");
  const auto found = diffma::scan(view(opcodes), bits);
  return {found.steps, found.raws, static_cast<int>(found.fault), found.fault_at};
}

void decode(const nb::bytes& opcodes, const Values& table, const Output& values, int bits,
            std::size_t window, double bound, int order) {
  const auto parameters = parameters_of(bits, window, bound, order);
  const auto text = view(opcodes);
  nb::gil_scoped_release unlocked;
  diffma::decode(text, {table.data(), table.size()}, parameters, {values.data(), values.size()});
}

}  // namespace

void bind_diffma(nanobind::module_& module) {
  module.def("diffma_encode", &encode, nb::arg("values"), nb::arg("bits"), nb::arg("window"),
             nb::arg("bound"), nb::arg("order"), nb::arg("tolerance"), nb::arg("round_offset"),
             nb::arg("max_error"), nb::arg("spare_signs"));
  module.def("diffma_scan", &scan, nb::arg("opcodes"), nb::arg("bits"));
  module.def("diffma_decode", &decode, nb::arg("opcodes"), nb::arg("table"), nb::arg("values"),
             nb::arg("bits"), nb::arg("window"), nb::arg("bound"), nb::arg("order"));
}

}  // namespace mocapress
