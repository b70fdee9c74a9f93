// Python's view of formats/table.hpp.
#include "formats/table.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <deque>
#include <memory>

#include "python/bindings.hpp"
#include "python/number_formats.hpp"

namespace mocapress {
namespace {

nb::bytes bytes_of(std::string_view text) { return nb::bytes(text.data(), text.size()); }

using Delimiters = std::vector<nb::bytes>;

TableCut cut_of(const Delimiters& delimiters, const nb::bytes& line_break, std::size_t width) {
  const bool fit = delimiters.size() == 1 || delimiters.size() + 1 == width;
  if (!fit || delimiters.empty() || line_break.size() == 0 || width == 0)
    throw nb::value_error("no way to cut a table");
  TableCut cut{{}, std::string(text_of(line_break)), width};
  for (const auto& one : delimiters) cut.delimiters.emplace_back(text_of(one));
  return cut;
}

// Kind, format, width, missing, text; first, step, divisor.
using ColumnTuple =
    std::tuple<int, nb::bytes, std::size_t, nb::bytes, nb::bytes, double, double, double>;
// How many, and the record.
using Texts = std::pair<std::uint64_t, nb::bytes>;

TableColumn column_of(const ColumnTuple& told) {
  const auto& [kind, format, width, missing, text, first, step, divisor] = told;
  if (kind < 0 || kind > 3 || format.size() != 4) throw nb::value_error("no such column");
  return {static_cast<TableKind>(kind),
          number_format(view(format).data()),
          width,
          text_of(missing),
          text_of(text),
          first,
          step,
          divisor};
}

std::vector<TableColumn> columns_of(const std::vector<ColumnTuple>& told) {
  std::vector<TableColumn> columns;
  columns.reserve(told.size());
  for (const auto& one : told) columns.push_back(column_of(one));
  return columns;
}

void survey(TableSurvey& self, const nb::bytes& text, std::size_t sampled) {
  const nb::gil_scoped_release release;
  self.add(text_of(text), sampled);
}

// Numbers, missing, texts, whether all cells are the same and the first; the width to which numbers
// are padded, the text for no number; whether numbers rise, first, last and longest step.
using Surveyed = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t, bool, nb::bytes,
                            std::size_t, nb::bytes, bool, double, double, double>;

Surveyed surveyed(const ColumnSurvey& column) {
  const auto& lengths = column.lengths;
  // Of equally many, the longest.
  const auto longest = std::max_element(lengths.rbegin(), lengths.rend());
  const auto width = static_cast<std::size_t>(lengths.rend() - longest) - 1;
  const auto gone =
      std::max_element(column.gone.begin(), column.gone.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return {column.numbers,
          column.missing,
          column.texts,
          column.same,
          bytes_of(column.first),
          column.padded ? width : 0,
          bytes_of(gone == column.gone.end() ? "" : gone->first),
          column.rises,
          column.begin,
          column.last,
          column.longest_step};
}

// Keeps the bytes alive that its columns look at.
class Matcher {
 public:
  Matcher(const Delimiters& delimiters, const nb::bytes& line_break,
          std::vector<ColumnTuple> columns)
      : told_(std::move(columns)),
        matcher_(cut_of(delimiters, line_break, told_.size()), columns_of(told_)) {
    for (const auto& one : told_) numbers_ += std::get<0>(one) == 0;
  }

  Given<double, 2> match(const nb::bytes& text) {
    std::vector<double> values;
    const std::uint64_t before = matcher_.rows;
    {
      const nb::gil_scoped_release release;
      matcher_.match(text_of(text), values);
    }
    return give(std::move(values), std::array<std::size_t, 2>{matcher_.rows - before, numbers_});
  }
  std::uint64_t rows() const { return matcher_.rows; }
  std::vector<std::uint64_t> counts() const {
    std::vector<std::uint64_t> counts;
    for (const auto& column : matcher_.others) counts.push_back(column.count);
    return counts;
  }
  // What the layout keeps: how much, in bytes.
  std::uint64_t kept() const {
    std::uint64_t sum = matcher_.verbatim.record.size();
    for (const auto& column : matcher_.others) sum += column.record.size();
    for (const auto& text : matcher_.texts) sum += text.size();
    return sum;
  }
  Texts others(std::size_t column) const { return texts_of(matcher_.others.at(column)); }
  nb::bytes texts(std::size_t column) const { return bytes_of(matcher_.texts.at(column)); }
  Texts verbatim() const { return texts_of(matcher_.verbatim); }

 private:
  static Texts texts_of(const TextsWriter& writer) {
    return {writer.count, bytes_of(writer.record)};
  }

  std::vector<ColumnTuple> told_;
  TableMatcher matcher_;
  std::size_t numbers_ = 0;
};

class Printer {
 public:
  Printer(const Delimiters& delimiters, const nb::bytes& line_break,
          std::vector<ColumnTuple> columns, std::vector<Texts> others, Texts verbatim,
          std::uint64_t rows)
      : told_(std::move(columns)),
        others_(std::move(others)),
        verbatim_(std::move(verbatim)),
        printer_(cut_of(delimiters, line_break, told_.size()), columns_of(told_), viewed(),
                 {verbatim_.first, text_of(verbatim_.second)}, rows) {
    if (others_.size() != told_.size()) throw nb::value_error("lists of mismatched lengths");
    for (const auto& one : told_) numbers_ += std::get<0>(one) == 0;
  }

  nb::bytes print(const Input<double, 2>& values, std::uint64_t most) {
    if (values.shape(1) != numbers_) throw nb::value_error("values of another width");
    std::string out;
    bool whole = false;
    {
      const nb::gil_scoped_release release;
      whole = printer_.print(out, values.data(), values.shape(0), most);
    }
    if (!whole) throw nb::value_error("a table longer than announced, or with too few texts");
    return bytes_of(out);
  }

 private:
  std::vector<std::pair<std::uint64_t, std::string_view>> viewed() const {
    std::vector<std::pair<std::uint64_t, std::string_view>> views;
    for (const auto& [count, record] : others_) views.emplace_back(count, text_of(record));
    return views;
  }

  std::vector<ColumnTuple> told_;
  std::vector<Texts> others_;
  Texts verbatim_;
  TablePrinter printer_;
  std::size_t numbers_ = 0;
};

std::size_t bound_pass_texts(const nb::bytes& record, std::size_t begin, std::uint64_t count,
                             std::uint64_t most_place, bool steps) {
  const std::string_view text = text_of(record);
  if (begin > text.size()) throw nb::value_error("an offset outside the record");
  return begin + pass_texts(text.substr(begin), count, most_place, steps);
}

}  // namespace

void bind_table(nb::module_& module) {
  const auto delimiters = nb::arg("delimiters");
  const auto line_break = nb::arg("line_break");
  const auto text = nb::arg("text");
  const auto column = nb::arg("column");
  nb::class_<TableSurvey>(module, "TableSurvey",
                          "What columns of a table hold, looked at in parts.")
      .def(
          "__init__",
          [](TableSurvey* self, const Delimiters& delimiters_, const nb::bytes& line_break_,
             std::size_t width) {
            new (self) TableSurvey(cut_of(delimiters_, line_break_, width));
          },
          delimiters, line_break, nb::arg("width"))
      .def("add", &survey, text, nb::arg("sampled"),
           "Take whole lines; of so many rows, spread evenly, the cells are kept.")
      .def_ro("rows", &TableSurvey::rows)
      .def_prop_ro(
          "columns",
          [](const TableSurvey& self) {
            std::vector<Surveyed> columns;
            for (const auto& one : self.columns) columns.push_back(surveyed(one));
            return columns;
          },
          "Numbers, missing, texts, whether all cells are the same, the first; the width to which\n"
          "numbers are padded, the text for no number; whether numbers rise, the first, the last\n"
          "and the longest step.")
      .def(
          "sample",
          [](const TableSurvey& self, std::size_t wanted) {
            std::vector<std::pair<std::uint64_t, nb::bytes>> cells;
            for (std::size_t i = 0; i < self.sample.size(); ++i)
              cells.emplace_back(self.sampled_rows[i], bytes_of(self.sample[i].at(wanted)));
            return cells;
          },
          column, "Give row and text of the cells of a column that were kept.")
      .def(
          "formats", [](const TableSurvey& self) { return packed(self.formats()); },
          "Choose a format per column, (C, 4), as docs/format/layout.md has them.");
  nb::class_<Matcher>(module, "TableMatcher",
                      "Compares a table with what its columns print, and takes its numbers out.\n\n"
                      "A column is kind, format, width, missing, text; first, step and divisor.")
      .def(nb::init<const Delimiters&, const nb::bytes&, std::vector<ColumnTuple>>(), delimiters,
           line_break, nb::arg("columns"))
      .def("match", &Matcher::match, text, "Take whole lines; give the numbers of their rows.")
      .def_prop_ro("rows", &Matcher::rows)
      .def_prop_ro("counts", &Matcher::counts, "Of cells that are written otherwise, per column.")
      .def_prop_ro("kept", &Matcher::kept, "Bytes of all that is kept.")
      .def("others", &Matcher::others, column)
      .def("texts", &Matcher::texts, column)
      .def("verbatim", &Matcher::verbatim);
  nb::class_<Printer>(module, "TablePrinter", "Prints a table, a run of rows after the other.")
      .def(nb::init<const Delimiters&, const nb::bytes&, std::vector<ColumnTuple>,
                    std::vector<Texts>, Texts, std::uint64_t>(),
           delimiters, line_break, nb::arg("columns"), nb::arg("others"), nb::arg("verbatim"),
           nb::arg("rows"))
      .def("print", &Printer::print, nb::arg("values"), nb::arg("most"),
           "Print the next rows; ValueError where they have more bytes.");
  module.def("pass_texts", &bound_pass_texts, nb::arg("record"), nb::arg("begin"), nb::arg("count"),
             nb::arg("most_place"), nb::arg("steps"),
             "Give where so many texts end in a record; ValueError where they are none.");
}

}  // namespace mocapress
