// Tables of numbers as text, read and printed a run of rows at a time: cells between delimiters,
// rows between line breaks. docs/format/table.md says how cells come about.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/detect.hpp"
#include "numbers/text.hpp"

namespace mocapress {

// How lines are cut into cells. A line of another width is no row.
struct TableCut {
  // One for all gaps between cells, or one for each gap. An empty one means that cells are aligned
  // by the blanks that they begin with.
  std::vector<std::string> delimiters;
  std::string line_break;
  std::size_t width = 1;

  // Before a cell that is not the first.
  const std::string& before(std::size_t cell) const {
    return delimiters.size() == 1 ? delimiters[0] : delimiters[cell - 1];
  }
};

enum class CellKind : std::uint8_t { number, missing, text };

struct Cell {
  std::string_view text;
  CellKind kind = CellKind::text;
  double value = 0;  // NaN where it is no number
  NumberShape shape;
};

Cell read_cell(std::string_view text);

// The lines of a text, without the line breaks between them.
std::vector<std::string_view> lines_of(std::string_view text, std::string_view line_break);
// The cells of a line; false where it has another number of them.
bool cells_of(std::string_view line, const TableCut& cut, std::vector<std::string_view>& cells);

// What a column holds, as far as it was looked at.
struct ColumnSurvey {
  std::uint64_t numbers = 0, missing = 0, texts = 0;
  bool same = true;  // all cells have one text
  std::string first;
  ColumnStatistics statistics;
  bool padded = false;
  std::array<std::uint32_t, 256> lengths{};                 // how many numbers have so many bytes
  std::vector<std::pair<std::string, std::uint64_t>> gone;  // texts that stand for no number
  bool rises = true;  // every number is there and above the one before
  double begin = 0, last = 0, longest_step = 0;
};

// Looks at parts of a table to tell what its columns hold.
class TableSurvey {
 public:
  explicit TableSurvey(TableCut cut) : columns(cut.width), cut_(std::move(cut)) {}

  // Takes whole lines; of so many rows, spread evenly, the cells are kept.
  void add(std::string_view text, std::size_t sampled);
  std::vector<NumberFormat> formats() const;

  std::vector<ColumnSurvey> columns;
  std::uint64_t rows = 0;
  std::vector<std::vector<std::string>> sample;  // rows of cells
  std::vector<std::uint64_t> sampled_rows;

 private:
  void take(ColumnSurvey& column, std::string_view text);

  TableCut cut_;
};

enum class TableKind : std::uint8_t { numbers, same, texts, series };

// How the cells of a column come about. Views are of what must live as long.
struct TableColumn {
  TableKind kind = TableKind::numbers;
  NumberFormat format;
  std::size_t width = 0;
  std::string_view missing;
  std::string_view text;  // of all cells, or all texts with line feeds between them
  double first = 0, step = 0, divisor = 1;
};

// Texts as a layout keeps them, by their places in ascending order: of each an integer, the place
// or the steps from the one before, the length, and the bytes.
struct TextsWriter {
  bool steps = true;
  std::uint64_t count = 0;
  std::string record;
  std::uint64_t last = 0;

  void add(std::uint64_t place, std::string_view text);
};

// Passes so many such texts, whose places are at most a number; gives where they end.
std::size_t pass_texts(std::string_view record, std::uint64_t count, std::uint64_t most_place,
                       bool steps);

// Compares a table with what its columns print, and takes its numbers out.
class TableMatcher {
 public:
  TableMatcher(TableCut cut, std::vector<TableColumn> columns);

  // Takes whole lines; appends the numbers of their rows, row by row.
  void match(std::string_view text, std::vector<double>& values);

  std::uint64_t rows = 0;
  std::vector<TextsWriter> others;       // cells that are written otherwise, by column
  std::vector<std::string> texts;        // of columns of texts
  TextsWriter verbatim{.steps = false};  // lines that are no rows

 private:
  TableCut cut_;
  std::vector<TableColumn> columns_;
  std::uint64_t line_ = 0;
};

// Prints a table, a run of rows after the other.
class TablePrinter {
 public:
  // `others` and `verbatim` are counts and records that `pass_texts` has passed.
  TablePrinter(TableCut cut, std::vector<TableColumn> columns,
               const std::vector<std::pair<std::uint64_t, std::string_view>>& others,
               std::pair<std::uint64_t, std::string_view> verbatim, std::uint64_t rows);

  // Appends the next rows, whose numbers are `values`; false once there are more than `most` bytes,
  // or where a column of texts has no more.
  bool print(std::string& out, const double* values, std::uint64_t count, std::uint64_t most);

 private:
  // Goes through what a TextsWriter wrote.
  struct Cursor {
    std::string_view left;
    std::uint64_t count = 0;
    bool steps = true;
    std::uint64_t place = 0;
    std::string_view text;
    void next();
  };

  void line(std::string& out);
  bool cell(std::string& out, std::size_t index, const double*& values);

  TableCut cut_;
  std::vector<TableColumn> columns_;
  std::vector<Cursor> others_;
  Cursor verbatim_;
  std::uint64_t rows_;
  std::uint64_t row_ = 0, line_ = 0;
};

}  // namespace mocapress
