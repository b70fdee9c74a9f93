#include "formats/table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coding/fail.hpp"
#include "coding/record.hpp"
#include "formats/text.hpp"

namespace mocapress {
namespace {

constexpr std::size_t kMostGone = 8;  // texts for no number that are counted apart
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool is_missing(std::string_view text) {
  if (text.empty()) return true;
  if (text.size() > 16) return false;
  std::string word = lower(text);
  if (word.ends_with("(ind)")) word.resize(word.size() - 5);
  if (word.size() > 1 && (word[0] == '-' || word[0] == '+')) word.erase(0, 1);
  for (const std::string_view start : {"1.#qnan", "1.#ind"}) {
    if (word.starts_with(start)) return word.find_first_not_of('0', start.size()) == word.npos;
  }
  return word == "nan" || word == "na" || word == "n/a" || word == "#n/a" || word == "null" ||
         word == "none" || word == "-";
}

// The bytes of a number in its column.
std::string_view printed(const TableColumn& column, double value, std::string& buffer) {
  if (std::isnan(value) && column.width <= column.missing.size()) return column.missing;
  char number[kLongestNumber];
  std::string_view text = column.missing;
  if (!std::isnan(value)) {
    const char* const end = print_number(number, value, column.format);
    text = {number, static_cast<std::size_t>(end - number)};
  }
  buffer.assign(column.width > text.size() ? column.width - text.size() : 0, ' ');
  buffer += text;
  return buffer;
}

double series(const TableColumn& column, std::uint64_t row) {
  const double moved = column.step * static_cast<double>(row);
  return (column.first + moved) / column.divisor;
}

void write(std::string& record, std::uint64_t value) {
  for (; value > 0x7F; value >>= 7) record.push_back(static_cast<char>(value & 0x7F | 0x80));
  record.push_back(static_cast<char>(value));
}

ByteView bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

Cell read_cell(std::string_view text) {
  Cell cell{text, CellKind::text, kNone, {}};
  const std::string_view bare = trimmed(text);
  const char* const begin = bare.data();
  const char* const end = begin + bare.size();
  double value = 0;
  if (!bare.empty() && parse_number(begin, end, value, cell.shape) == end) {
    cell.kind = CellKind::number;
    cell.value = value;
  } else if (is_missing(bare)) {
    cell.kind = CellKind::missing;
  }
  return cell;
}

std::vector<std::string_view> lines_of(std::string_view text, std::string_view line_break) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0;;) {
    const std::size_t end = text.find(line_break, at);
    lines.push_back(text.substr(at, end - at));
    if (end == std::string_view::npos) return lines;
    at = end + line_break.size();
  }
}

bool cells_of(std::string_view line, const TableCut& cut, std::vector<std::string_view>& cells) {
  cells.clear();
  for (std::size_t at = 0;;) {
    const bool last = cells.size() + 1 == cut.width;
    // Where one delimiter stands between all, none may follow the last cell.
    const std::string& next = cut.before(last && cut.width > 1 ? cells.size() : cells.size() + 1);
    std::size_t end = 0;
    if (next.empty()) {
      const std::size_t begin = line.find_first_not_of(' ', at);
      if (begin == std::string_view::npos) return false;
      end = line.find(' ', begin);
    } else {
      end = line.find(next, at);
    }
    if (last != (end == std::string_view::npos)) return false;
    cells.push_back(line.substr(at, end - at));
    if (last) return true;
    at = end + next.size();
  }
}

void TableSurvey::take(ColumnSurvey& column, std::string_view text) {
  if (rows == 0) column.first = text;
  column.same = column.same && text == column.first;
  const Cell cell = read_cell(text);
  if (cell.kind == CellKind::missing) {
    ++column.missing;
    column.rises = false;
    const auto known = std::find_if(column.gone.begin(), column.gone.end(),
                                    [&](const auto& one) { return one.first == text; });
    if (known != column.gone.end()) {
      ++known->second;
    } else if (column.gone.size() < kMostGone) {
      column.gone.emplace_back(text, 1);
    }
    return;
  }
  if (cell.kind == CellKind::text) {
    ++column.texts;
    column.rises = false;
    return;
  }
  note(column.statistics, cell.shape);
  column.padded = column.padded || text.front() == ' ';
  if (text.size() < column.lengths.size()) ++column.lengths[text.size()];
  if (column.numbers == 0) {
    column.begin = cell.value;
  } else {
    column.rises = column.rises && cell.value > column.last;
    column.longest_step = std::max(column.longest_step, cell.value - column.last);
  }
  column.last = cell.value;
  ++column.numbers;
}

void TableSurvey::add(std::string_view text, std::size_t sampled) {
  const auto lines = lines_of(text, cut_.line_break);
  const std::size_t every =
      std::max<std::size_t>(lines.size() / std::max<std::size_t>(sampled, 1), 1);
  std::vector<std::string_view> cells;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!cells_of(lines[i], cut_, cells)) continue;
    for (std::size_t c = 0; c < cells.size(); ++c) take(columns[c], cells[c]);
    if (i % every == 0 || i + 1 == lines.size()) {
      sample.emplace_back(cells.begin(), cells.end());
      sampled_rows.push_back(rows);
    }
    ++rows;
  }
}

std::vector<NumberFormat> TableSurvey::formats() const {
  std::vector<ColumnStatistics> statistics;
  statistics.reserve(columns.size());
  for (const auto& column : columns) statistics.push_back(column.statistics);
  Sample some;
  for (const auto& row : sample) {
    for (const auto& text : row) {
      const Cell cell = read_cell(text);
      const bool number = cell.kind == CellKind::number;
      some.values.push_back(number ? cell.value : 0);
      some.texts.push_back(number ? trimmed(text) : std::string_view());
    }
  }
  return detect_formats(statistics, some);
}

void TextsWriter::add(std::uint64_t place, std::string_view text) {
  write(record, steps ? place - last : place);
  write(record, text.size());
  record += text;
  last = place;
  ++count;
}

std::size_t pass_texts(std::string_view record, std::uint64_t count, std::uint64_t most_place,
                       bool steps) {
  Record left(bytes_of(record));
  std::uint64_t place = 0;
  for (; count > 0; --count) {
    const std::uint64_t told = left.integer(steps ? most_place - place : most_place);
    if (!steps && told < place) fail("texts in the wrong order");
    place = steps ? place + told : told;
    left.bytes();
  }
  return record.size() - left.left();
}

TableMatcher::TableMatcher(TableCut cut, std::vector<TableColumn> columns)
    : others(columns.size()),
      texts(columns.size()),
      cut_(std::move(cut)),
      columns_(std::move(columns)) {}

void TableMatcher::match(std::string_view text, std::vector<double>& values) {
  std::vector<std::string_view> cells;
  std::string buffer;
  for (const std::string_view line : lines_of(text, cut_.line_break)) {
    if (!cells_of(line, cut_, cells)) {
      verbatim.add(line_++, line);
      continue;
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const TableColumn& column = columns_[c];
      std::string_view expected = column.text;
      if (column.kind == TableKind::texts) {
        if (rows > 0) texts[c] += '\n';
        // Where lines end otherwise, a cell may hold a line feed, which would end its text.
        if (cells[c].find('\n') == std::string_view::npos) {
          texts[c] += cells[c];
        } else {
          others[c].add(rows, cells[c]);
        }
        continue;
      }
      if (column.kind == TableKind::series) {
        expected = printed(column, series(column, rows), buffer);
      } else if (column.kind == TableKind::numbers) {
        values.push_back(read_cell(cells[c]).value);
        expected = printed(column, values.back(), buffer);
      }
      if (expected != cells[c]) others[c].add(rows, cells[c]);
    }
    ++rows;
    ++line_;
  }
}

void TablePrinter::Cursor::next() {
  if (count == 0) {
    place = std::numeric_limits<std::uint64_t>::max();
    return;
  }
  --count;
  Record record(bytes_of(left));
  place = steps ? place + record.integer() : record.integer();
  const ByteView bytes = record.bytes();
  text = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  left.remove_prefix(left.size() - record.left());
}

TablePrinter::TablePrinter(TableCut cut, std::vector<TableColumn> columns,
                           const std::vector<std::pair<std::uint64_t, std::string_view>>& others,
                           std::pair<std::uint64_t, std::string_view> verbatim, std::uint64_t rows)
    : cut_(std::move(cut)),
      columns_(std::move(columns)),
      verbatim_{.left = verbatim.second, .count = verbatim.first, .steps = false},
      rows_(rows) {
  for (const auto& [count, record] : others) others_.push_back({.left = record, .count = count});
  for (auto& cursor : others_) cursor.next();
  verbatim_.next();
}

// Begins a line, after those that are no rows.
void TablePrinter::line(std::string& out) {
  if (line_++ > 0) out += cut_.line_break;
}

bool TablePrinter::cell(std::string& out, std::size_t index, const double*& values) {
  TableColumn& column = columns_[index];
  std::string_view text = column.text;
  std::string buffer;
  if (column.kind == TableKind::texts) {
    const std::size_t end = text.find('\n');
    // The last row has the last text.
    if ((end == std::string_view::npos) != (row_ + 1 == rows_)) return false;
    text = text.substr(0, end);
    if (end != std::string_view::npos) column.text.remove_prefix(end + 1);
  }
  double value = 0;
  if (column.kind == TableKind::numbers) value = *values++;
  Cursor& other = others_[index];
  if (other.place == row_) {
    // Of several texts for one cell the last counts.
    for (; other.place == row_; other.next()) text = other.text;
  } else if (column.kind == TableKind::numbers) {
    text = printed(column, value, buffer);
  } else if (column.kind == TableKind::series) {
    text = printed(column, series(column, row_), buffer);
  }
  out += text;
  return true;
}

bool TablePrinter::print(std::string& out, const double* values, std::uint64_t count,
                         std::uint64_t most) {
  const auto unlike = [&] {
    line(out);
    out += verbatim_.text;
    verbatim_.next();
    return out.size() <= most;
  };
  for (; count > 0; --count, ++row_) {
    while (verbatim_.place == line_)
      if (!unlike()) return false;
    line(out);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (c > 0) out += cut_.before(c);
      if (!cell(out, c, values) || out.size() > most) return false;
    }
  }
  if (row_ == rows_) {
    while (verbatim_.place != std::numeric_limits<std::uint64_t>::max())
      if (!unlike()) return false;
  }
  return true;
}

}  // namespace mocapress
