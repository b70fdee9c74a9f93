// Python's view of numbers/text.hpp and formats/rows.hpp.
//
// Number formats travel as a (C, 6) uint8 array: kind, digits, exponent_digits, point_zero,
// bare_point, upper.
#include "formats/rows.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <stdexcept>
#include <utility>

#include "numbers/text.hpp"
#include "python/bindings.hpp"

namespace nb = nanobind;

namespace mocapress {
namespace {

using Values = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Formats = nb::ndarray<const uint8_t, nb::shape<-1, 6>, nb::c_contig, nb::device::cpu>;
template <typename T>
using Input = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
// counter, literals, columns, widths
using TemplateTuple =
    std::tuple<bool, std::vector<nb::bytes>, std::vector<uint32_t>, std::vector<uint8_t>>;

std::string_view view(const nb::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }

// Hands a vector over to NumPy without a copy.
template <typename T>
nb::ndarray<nb::numpy, T> give(std::vector<T>&& data, std::vector<size_t> shape) {
  auto owned = std::make_unique<std::vector<T>>(std::move(data));
  T* const pointer = owned->data();
  nb::capsule owner(owned.release(),
                    [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::ndarray<nb::numpy, T>(pointer, shape.size(), shape.data(), owner);
}

template <typename T>
nb::ndarray<nb::numpy, T> give(std::vector<T>&& data) {
  const size_t size = data.size();
  return give(std::move(data), {size});
}

NumberFormat number_format(const uint8_t* f) {
  if (f[0] > 5 || f[1] > max_digits || f[2] > 8 || (f[0] == 0 && (f[1] < 1 || f[1] > 17)))
    throw nb::value_error("no such number format");
  return {static_cast<NumberKind>(f[0]), f[1], f[2], f[3] != 0, f[4] != 0, f[5] != 0};
}

std::vector<NumberFormat> number_formats(const Formats& formats) {
  std::vector<NumberFormat> list(formats.shape(0));
  for (size_t c = 0; c < list.size(); ++c) list[c] = number_format(formats.data() + 6 * c);
  return list;
}

std::vector<RowTemplate> row_templates(const std::vector<TemplateTuple>& tuples, size_t columns) {
  std::vector<RowTemplate> templates;
  for (const auto& [counter, literals, slots, widths] : tuples) {
    if (literals.size() != slots.size() + 1 + counter || widths.size() != slots.size())
      throw nb::value_error("row template of mismatched parts");
    RowTemplate row{counter, {}, slots, widths};
    for (const auto& literal : literals) row.literals.emplace_back(view(literal));
    for (const uint32_t column : slots)
      if (column >= columns) throw nb::value_error("row template names a column that is not there");
    templates.push_back(std::move(row));
  }
  return templates;
}

auto bound_parse_rows(const nb::bytes& data, uint64_t begin, bool counter,
                      const std::vector<nb::bytes>& words, std::vector<uint32_t> counts,
                      uint64_t most_rows) {
  if (words.size() != counts.size() || begin > data.size())
    throw nb::value_error("row shape of mismatched parts");
  RowShape shape{counter, {}, std::move(counts)};
  for (const auto& word : words) shape.words.emplace_back(view(word));
  const size_t columns = shape.columns();
  ParsedRows rows;
  {
    const nb::gil_scoped_release release;
    rows = parse_rows(view(data), begin, shape, most_rows);
  }
  std::vector<uint8_t> statistics;
  for (const auto& column : rows.statistics)
    statistics.insert(statistics.end(),
                      {column.least_decimals, column.most_decimals, column.most_significant,
                       column.exponent_digits, column.trailing_zero, column.whole_without_point,
                       column.bare_point, column.upper});
  const size_t count = rows.offsets.size() - 1;
  return nb::make_tuple(give(std::move(rows.values), {count, columns}),
                        give(std::move(rows.counters)), give(std::move(rows.offsets)),
                        give(std::move(statistics), {columns, 8}), static_cast<int>(rows.end),
                        rows.error_offset, rows.error_item);
}

// Compares the selected rows with one template.
auto bound_match_rows(const nb::bytes& data, const Input<uint64_t>& offsets,
                      const Input<int64_t>& counters, const Values& values,
                      const Input<int64_t>& selected, const TemplateTuple& tuple,
                      const Formats& formats) {
  const size_t rows = values.shape(0);
  const size_t columns = values.shape(1);
  if (offsets.shape(0) != rows + 1 || formats.shape(0) != columns ||
      (counters.shape(0) != rows && (counters.shape(0) != 0 || std::get<0>(tuple))))
    throw nb::value_error("arrays of mismatched lengths");
  const RowTemplate row = row_templates({tuple}, columns)[0];
  const auto list = number_formats(formats);
  const std::string_view text = view(data);
  std::vector<uint8_t> matched(selected.shape(0));
  std::vector<uint64_t> cell_rows;
  std::vector<uint32_t> cell_slots;
  std::vector<std::string_view> cell_texts;
  {
    const nb::gil_scoped_release release;
    std::vector<SlotText> differing;
    for (size_t i = 0; i < matched.size(); ++i) {
      const auto r = static_cast<uint64_t>(selected.data()[i]);
      if (r >= rows) throw std::out_of_range("no such row");
      const uint64_t from = offsets.data()[r];
      const uint64_t to = offsets.data()[r + 1];
      if (from > to || to > text.size()) throw std::out_of_range("row outside the data");
      if (!match_row(text.substr(from, to - from), row, values.data() + r * columns,
                     row.counter ? counters.data()[r] : 0, list.data(), differing))
        continue;
      matched[i] = 1;
      for (const auto& cell : differing) {
        cell_rows.push_back(r);
        cell_slots.push_back(cell.slot);
        cell_texts.push_back(cell.text);
      }
    }
  }
  nb::list texts;
  for (const auto& cell : cell_texts) texts.append(nb::bytes(cell.data(), cell.size()));
  return nb::make_tuple(give(std::move(matched)), give(std::move(cell_rows)),
                        give(std::move(cell_slots)), texts);
}

// Stops once it has printed more than `most_bytes`. Cells are sorted by row, then slot; whole rows
// (template -1) take their bytes from `raw`, in order.
nb::bytes bound_print_rows(const Values& values, const Input<int64_t>& counters,
                           const Input<int32_t>& assigned, const std::vector<TemplateTuple>& tuples,
                           const Formats& formats, const Input<uint64_t>& cell_rows,
                           const Input<uint32_t>& cell_slots, const std::vector<nb::bytes>& cells,
                           const std::vector<nb::bytes>& raw, uint64_t most_bytes) {
  const size_t rows = values.shape(0);
  const size_t columns = values.shape(1);
  if (assigned.shape(0) != rows || formats.shape(0) != columns ||
      (counters.shape(0) != rows && counters.shape(0) != 0) || cell_rows.shape(0) != cells.size() ||
      cell_slots.shape(0) != cells.size())
    throw nb::value_error("arrays of mismatched lengths");
  const auto templates = row_templates(tuples, columns);
  const auto list = number_formats(formats);
  std::vector<std::string_view> cell_views;
  std::vector<std::string_view> raw_views;
  for (const auto& cell : cells) cell_views.push_back(view(cell));
  for (const auto& row : raw) raw_views.push_back(view(row));
  std::string out;
  {
    const nb::gil_scoped_release release;
    size_t cell = 0;
    size_t next_raw = 0;
    std::vector<SlotText> replaced;
    for (size_t r = 0; r < rows; ++r) {
      if (out.size() > most_bytes) break;
      const int32_t index = assigned.data()[r];
      if (index < 0) {
        if (next_raw == raw_views.size()) throw std::out_of_range("a row has no template");
        out += raw_views[next_raw++];
        continue;
      }
      if (static_cast<size_t>(index) >= templates.size() ||
          (templates[index].counter && counters.shape(0) == 0))
        throw std::out_of_range("a row has no template");
      replaced.clear();
      for (; cell < cell_views.size() && cell_rows.data()[cell] == r; ++cell)
        replaced.push_back({cell_slots.data()[cell], cell_views[cell]});
      print_row(out, templates[index], values.data() + r * columns,
                templates[index].counter ? counters.data()[r] : 0, list.data(), replaced);
    }
  }
  return nb::bytes(out.data(), out.size());
}

}  // namespace

void bind_rows(nb::module_& module) {
  module.def("parse_rows", &bound_parse_rows);
  module.def("match_rows", &bound_match_rows);
  module.def("print_rows", &bound_print_rows);
}

}  // namespace mocapress
