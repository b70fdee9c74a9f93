// Tables in any text: what the columns do not print is kept, and text and numbers make the table
// again; what a layout keeps may be any bytes.
#include "formats/table.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>

using namespace mocapress;

namespace {

using Texts = std::pair<std::uint64_t, std::string_view>;

void check_table(const TableCut& cut, std::string_view text, unsigned choice) {
  TableSurvey survey(cut);
  survey.add(text, 5);
  const auto formats = survey.formats();
  std::vector<TableColumn> columns(cut.width);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const ColumnSurvey& seen = survey.columns[c];
    TableColumn& column = columns[c];
    column.kind = static_cast<TableKind>((choice >> 2 * c % 8) % 4);
    column.format = formats[c];
    column.width = seen.padded ? choice % 12 : 0;
    if (!seen.gone.empty()) column.missing = seen.gone.front().first;
    column.step = 1;
    if (column.kind == TableKind::same) column.text = seen.first;
  }
  TableMatcher matcher(cut, columns);
  std::vector<double> values;
  matcher.match(text, values);
  if (matcher.rows != survey.rows) std::abort();
  std::vector<Texts> others;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].kind == TableKind::texts) columns[c].text = matcher.texts[c];
    const TextsWriter& kept = matcher.others[c];
    others.emplace_back(kept.count, kept.record);
    const std::uint64_t most = std::max<std::uint64_t>(matcher.rows, 1) - 1;
    if (pass_texts(kept.record, kept.count, most, true) != kept.record.size()) std::abort();
  }
  const Texts verbatim(matcher.verbatim.count, matcher.verbatim.record);
  TablePrinter printer(cut, columns, others, verbatim, matcher.rows);
  std::string back;
  const auto numbers = static_cast<std::size_t>(
      std::count_if(columns.begin(), columns.end(),
                    [](const auto& column) { return column.kind == TableKind::numbers; }));
  // In two runs, of which the second may be empty.
  const std::uint64_t half = matcher.rows / 2;
  if (!printer.print(back, values.data(), half, text.size()) ||
      !printer.print(back, values.data() + half * numbers, matcher.rows - half, text.size()) ||
      back != text)
    std::abort();
}

// Any bytes as what a layout keeps.
void check_layout(const TableCut& cut, std::string_view text, unsigned choice) {
  std::vector<TableColumn> columns(cut.width);
  std::vector<Texts> others(cut.width);
  const std::uint64_t rows = 1 + choice % 7;
  const std::string_view part = text.substr(0, text.size() / 2);
  try {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      columns[c].kind = static_cast<TableKind>((choice >> c % 8) % 4);
      columns[c].text = text.substr(text.size() / 2);
      const std::uint64_t count = choice % 5;
      others[c] = {count, part.substr(0, pass_texts(part, count, rows - 1, true))};
    }
    const Texts verbatim(1, text.substr(0, pass_texts(text, 1, 1 << 20, false)));
    TablePrinter printer(cut, columns, others, verbatim, rows);
    const std::vector<double> values(rows * cut.width);
    std::string out;
    const std::size_t longest = 2 * text.size() + 600 + cut.line_break.size();
    printer.print(out, values.data(), rows, 500);
    if (out.size() > 500 + longest) std::abort();
  } catch (const std::invalid_argument&) {
    return;  // no such texts
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  const std::vector<std::string> delimiters{"\t", ",", "; ", " ", ""};
  TableCut cut{{delimiters[data[0] % 5]}, data[1] % 2 == 0 ? "\n" : "\r\n", 1U + data[1] / 2 % 6};
  if (data[0] >= 128 && cut.width > 1) {
    cut.delimiters.assign(cut.width - 1, cut.delimiters[0]);
    cut.delimiters[data[0] / 5 % (cut.width - 1)] = ",";
  }
  const std::string_view text(reinterpret_cast<const char*>(data) + 3, size - 3);
  check_table(cut, text, data[2]);
  check_layout(cut, text, data[2]);
  return 0;
}
