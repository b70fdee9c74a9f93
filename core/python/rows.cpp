// Python's view of numbers/text.hpp and formats/rows.hpp.
#include "formats/rows.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <stdexcept>
#include <utility>

#include "numbers/text.hpp"
#include "python/bindings.hpp"
#include "python/number_formats.hpp"

namespace mocapress {
namespace {

// counter, literals, columns, widths, width of the counter
using TemplateTuple = std::tuple<bool, std::vector<nb::bytes>, std::vector<std::uint32_t>,
                                 std::vector<std::uint8_t>, std::uint8_t>;

std::vector<RowTemplate> row_templates(const std::vector<TemplateTuple>& tuples,
                                       std::size_t columns) {
  std::vector<RowTemplate> templates;
  for (const auto& [counter, literals, slots, widths, counter_width] : tuples) {
    if (literals.size() != slots.size() + 1 + counter || widths.size() != slots.size())
      throw nb::value_error("row template of mismatched parts");
    RowTemplate row{counter, {}, slots, widths, counter_width};
    for (const auto& literal : literals) row.literals.emplace_back(text_of(literal));
    for (const std::uint32_t column : slots)
      if (column >= columns) throw nb::value_error("row template names a column that is not there");
    templates.push_back(std::move(row));
  }
  return templates;
}

// Compares the selected rows with one template.
using Matched = std::tuple<Given<std::uint8_t>, Given<std::uint64_t>, Given<std::uint32_t>,
                           std::vector<nb::bytes>>;

Matched bound_match_rows(const nb::bytes& data, const Input<std::uint64_t, 1>& offsets,
                         const Input<std::int64_t, 1>& counters, const Input<double, 2>& values,
                         const Input<std::int64_t, 1>& selected, const TemplateTuple& tuple,
                         const Formats& formats) {
  const std::size_t rows = values.shape(0);
  const std::size_t columns = values.shape(1);
  if (offsets.shape(0) != rows + 1 || formats.shape(0) != columns ||
      (counters.shape(0) != rows && (counters.shape(0) != 0 || std::get<0>(tuple))))
    throw nb::value_error("arrays of mismatched lengths");
  const RowTemplate row = row_templates({tuple}, columns)[0];
  const auto list = number_formats(formats);
  const std::string_view text = text_of(data);
  std::vector<std::uint8_t> matched(selected.shape(0));
  std::vector<std::uint64_t> cell_rows;
  std::vector<std::uint32_t> cell_slots;
  std::vector<std::string_view> cell_texts;
  {
    const nb::gil_scoped_release release;
    std::vector<SlotText> differing;
    for (std::size_t i = 0; i < matched.size(); ++i) {
      const auto r = static_cast<std::uint64_t>(selected.data()[i]);
      if (r >= rows) throw std::out_of_range("no such row");
      const std::uint64_t from = offsets.data()[r];
      const std::uint64_t to = offsets.data()[r + 1];
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
  std::vector<nb::bytes> texts;
  texts.reserve(cell_texts.size());
  for (const auto& cell : cell_texts) texts.emplace_back(cell.data(), cell.size());
  return {give(std::move(matched)), give(std::move(cell_rows)), give(std::move(cell_slots)),
          std::move(texts)};
}

// Stops once it has printed more than `most_bytes`. Cells are sorted by row, then slot; whole rows
// (template -1) take their bytes from `raw`, in order.
nb::bytes bound_print_rows(const Input<double, 2>& values, const Input<std::int64_t, 1>& counters,
                           const Input<std::int32_t, 1>& assigned,
                           const std::vector<TemplateTuple>& tuples, const Formats& formats,
                           const Input<std::uint64_t, 1>& cell_rows,
                           const Input<std::uint32_t, 1>& cell_slots,
                           const std::vector<nb::bytes>& cells, const std::vector<nb::bytes>& raw,
                           std::uint64_t most_bytes) {
  const std::size_t rows = values.shape(0);
  const std::size_t columns = values.shape(1);
  if (assigned.shape(0) != rows || formats.shape(0) != columns ||
      (counters.shape(0) != rows && counters.shape(0) != 0) || cell_rows.shape(0) != cells.size() ||
      cell_slots.shape(0) != cells.size())
    throw nb::value_error("arrays of mismatched lengths");
  const auto templates = row_templates(tuples, columns);
  const auto list = number_formats(formats);
  std::vector<std::string_view> cell_views;
  std::vector<std::string_view> raw_views;
  for (const auto& cell : cells) cell_views.push_back(text_of(cell));
  for (const auto& row : raw) raw_views.push_back(text_of(row));
  std::string out;
  {
    const nb::gil_scoped_release release;
    std::size_t cell = 0;
    std::size_t next_raw = 0;
    std::vector<SlotText> replaced;
    for (std::size_t r = 0; r < rows; ++r) {
      if (out.size() > most_bytes) break;
      const std::int32_t index = assigned.data()[r];
      if (index < 0) {
        if (next_raw == raw_views.size()) throw std::out_of_range("a row has no template");
        out += raw_views[next_raw++];
        continue;
      }
      if (static_cast<std::size_t>(index) >= templates.size() ||
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
  const auto data = nb::arg("data");
  const auto counters = nb::arg("counters");
  const auto values = nb::arg("values");
  const auto formats = nb::arg("formats");
  module.def("match_rows", &bound_match_rows, data, nb::arg("offsets"), counters, values,
             nb::arg("selected"), nb::arg("template"), formats,
             "Compare rows with a template: its counter, literals, columns, widths and the width\n"
             "of the counter.\n\n"
             "Formats are those of docs/format/layout.md, four bytes each. Gives which of the\n"
             "selected rows match, and the row, slot and text of numbers written otherwise.");
  module.def("print_rows", &bound_print_rows, values, counters, nb::arg("assigned"),
             nb::arg("templates"), formats, nb::arg("cell_rows"), nb::arg("cell_slots"),
             nb::arg("cells"), nb::arg("raw"), nb::arg("most_bytes"),
             "Print rows, each by the template assigned to it, until there are too many bytes.\n\n"
             "Cells, in order, stand for the numbers at their slots; rows without a template (-1)\n"
             "are the next of ``raw``.");
}

}  // namespace mocapress
