// What the bindings have in common. Every file binds its own functions; module.cpp calls them all.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "coding/bit.hpp"

namespace mocapress {

namespace nb = nanobind;

// Arrays of Python: read, filled in place, and handed over.
template <class Element, int kDimensions>
using Input = nb::ndarray<const Element, nb::ndim<kDimensions>, nb::c_contig, nb::device::cpu>;
template <class Element, int kDimensions>
using Output = nb::ndarray<Element, nb::ndim<kDimensions>, nb::c_contig, nb::device::cpu>;
template <class Element, int kDimensions = 1>
using Given = nb::ndarray<nb::numpy, Element, nb::ndim<kDimensions>>;
// (C, kFields): a row says how a column is coded.
template <class Element, int kFields>
using Plan = nb::ndarray<const Element, nb::shape<-1, kFields>, nb::c_contig, nb::device::cpu>;

inline std::string_view text_of(const nb::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }

inline ByteView view(const nb::bytes& bytes) {
  return {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

inline nb::bytes to_python(const Bytes& bytes) { return nb::bytes(bytes.data(), bytes.size()); }

// Hands a vector over to NumPy without a copy.
template <class Element, std::size_t kDimensions>
Given<Element, static_cast<int>(kDimensions)> give(
    std::vector<Element> data, const std::array<std::size_t, kDimensions>& shape) {
  auto owned = std::make_unique<std::vector<Element>>(std::move(data));
  Element* const elements = owned->data();
  const nb::capsule owner(owned.release(), [](void* pointer) noexcept {
    delete static_cast<std::vector<Element>*>(pointer);
  });
  return {elements, kDimensions, shape.data(), owner};
}

template <class Element>
Given<Element> give(std::vector<Element> data) {
  const std::array shape{data.size()};
  return give(std::move(data), shape);
}

void bind_c3d(nb::module_& module);
void bind_formats(nb::module_& module);
void bind_motion(nb::module_& module);
void bind_record(nb::module_& module);
void bind_rows(nb::module_& module);
void bind_table(nb::module_& module);
void bind_app(nb::module_& module);
void bind_exact(nb::module_& module);
void bind_diffma(nb::module_& module);
void bind_mrpa(nb::module_& module);
void bind_near(nb::module_& module);
void bind_patterns(nb::module_& module);
void bind_qssd(nb::module_& module);
void bind_qssd_learning(nb::module_& module);
void bind_search(nb::module_& module);

}  // namespace mocapress
