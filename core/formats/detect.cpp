#include "formats/detect.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace mocapress {
namespace {

constexpr std::size_t kMostKinds = 64;  // of columns, whose candidates are tried
constexpr unsigned kMostExponentDigits = 8;

ColumnStatistics merged(const std::vector<ColumnStatistics>& all) {
  ColumnStatistics sum;
  for (const ColumnStatistics& one : all) {
    sum.least_decimals = std::min(sum.least_decimals, one.least_decimals);
    sum.most_decimals = std::max(sum.most_decimals, one.most_decimals);
    sum.most_significant = std::max(sum.most_significant, one.most_significant);
    if (one.exponent_digits > 0 &&
        (sum.exponent_digits == 0 || one.exponent_digits < sum.exponent_digits))
      sum.exponent_digits = one.exponent_digits;
    sum.trailing_zero |= one.trailing_zero;
    sum.whole_without_point |= one.whole_without_point;
    sum.bare_point |= one.bare_point;
    sum.upper |= one.upper;
    sum.plus |= one.plus;
    sum.leading_zero |= one.leading_zero;
    sum.end_point |= one.end_point;
  }
  return sum;
}

void append_candidates(std::vector<NumberFormat>& found, const ColumnStatistics& seen) {
  const auto most = static_cast<std::uint8_t>(std::min<unsigned>(seen.most_decimals, kMostDigits));
  const unsigned significant = seen.most_significant;
  NumberFormat usual;
  if (seen.exponent_digits > 0) {
    const unsigned digits = std::clamp<unsigned>(seen.exponent_digits, 2, kMostExponentDigits);
    usual.exponent_digits = static_cast<std::uint8_t>(digits);
  }
  usual.bare_point = seen.bare_point;
  usual.upper = seen.upper;
  usual.plus = seen.plus;
  usual.zeros = seen.leading_zero;
  usual.end_point = seen.end_point;
  const auto add = [&](NumberKind kind, unsigned digits, bool point_zero = false) {
    NumberFormat format = usual;
    format.kind = kind;
    format.digits = static_cast<std::uint8_t>(digits);
    format.point_zero = point_zero;
    const auto known = [&](const NumberFormat& other) { return format == other; };
    if (std::none_of(found.begin(), found.end(), known)) found.push_back(format);
  };
  if (seen.least_decimals >= most) add(NumberKind::fixed, most);
  const bool point_zero = seen.trailing_zero && !seen.whole_without_point;
  if (!seen.trailing_zero || point_zero) {
    for (const unsigned digits : {std::max(significant, 1U), 6U})
      if (significant <= digits && digits <= 17) add(NumberKind::general, digits, point_zero);
    add(NumberKind::trimmed, most, point_zero);
    add(NumberKind::shortest, 0, point_zero);
    add(NumberKind::shortest32, 0, point_zero);
  }
  if (seen.least_decimals < most) add(NumberKind::fixed, most);
  if (seen.exponent_digits > 0 && significant > 0 && significant <= kMostDigits + 1)
    add(NumberKind::scientific, significant - 1);
  // Java and JavaScript write exponents with as few digits as they have.
  if (seen.exponent_digits > 2) return;
  usual.exponent_digits = 1;
  for (const NumberKind kind : {NumberKind::shortest, NumberKind::shortest32}) {
    usual.javascript = !seen.upper && !seen.trailing_zero;
    if (usual.javascript) add(kind, 0);
    usual.javascript = false;
    usual.java = usual.upper = !seen.whole_without_point || seen.upper;
    if (usual.java) add(kind, 0, true);
    usual.java = usual.upper = false;
  }
}

// Whether a number is written in a format, zeros that pad it aside.
bool is_written(std::string_view text, double value, const NumberFormat& format) {
  char buffer[kLongestNumber];
  const char* const end = print_number(buffer, value, format);
  const std::string_view printed(buffer, static_cast<std::size_t>(end - buffer));
  if (!format.zeros || printed.size() >= text.size()) return printed == text;
  const std::size_t sign = printed.front() == '-' || printed.front() == '+' ? 1 : 0;
  const std::size_t padding = text.size() - printed.size();
  return text.substr(0, sign) == printed.substr(0, sign) &&
         text.substr(sign + padding) == printed.substr(sign) &&
         text.substr(sign, padding).find_first_not_of('0') == std::string_view::npos;
}

}  // namespace

std::vector<NumberFormat> detect_formats(const std::vector<ColumnStatistics>& statistics,
                                         const Sample& sample) {
  const std::size_t columns = statistics.size();
  // How many numbers of each column are written otherwise; where `one` is enough, it stops there.
  const auto misses = [&](const NumberFormat& format, bool one) {
    std::vector<std::size_t> counts(columns);
    for (std::size_t i = 0; i < sample.values.size(); ++i) {
      if (sample.texts[i].empty() || is_written(sample.texts[i], sample.values[i], format))
        continue;
      ++counts[i % columns];
      if (one) break;
    }
    return counts;
  };
  const auto fits = [&](const NumberFormat& format) {
    const auto counts = misses(format, true);
    return std::all_of(counts.begin(), counts.end(), [](std::size_t count) { return count == 0; });
  };
  std::vector<NumberFormat> candidates;
  append_candidates(candidates, merged(statistics));
  // Numbers that no zeros pad fit a format of zeros, too.
  const auto by_column = [&](NumberFormat format, std::size_t c) {
    format.zeros = statistics[c].leading_zero;
    return format;
  };
  std::vector<NumberFormat> chosen;
  chosen.reserve(columns);
  for (const NumberFormat& format : candidates) {
    if (!fits(format)) continue;
    for (std::size_t c = 0; c < columns; ++c) chosen.push_back(by_column(format, c));
    return chosen;
  }
  std::vector<ColumnStatistics> kinds;
  for (const ColumnStatistics& one : statistics) {
    const auto known = [&](const ColumnStatistics& other) { return one == other; };
    if (kinds.size() == kMostKinds || std::any_of(kinds.begin(), kinds.end(), known)) continue;
    kinds.push_back(one);
    append_candidates(candidates, one);
  }
  std::vector<std::vector<std::size_t>> counts;
  counts.reserve(candidates.size());
  for (const NumberFormat& format : candidates) counts.push_back(misses(format, false));
  std::vector<std::size_t> least(columns, SIZE_MAX);
  for (const auto& count : counts)
    for (std::size_t c = 0; c < columns; ++c) least[c] = std::min(least[c], count[c]);
  std::vector<std::size_t> votes(candidates.size());
  for (std::size_t k = 0; k < counts.size(); ++k)
    for (std::size_t c = 0; c < columns; ++c) votes[k] += counts[k][c] == least[c];
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return votes[a] > votes[b]; });
  for (std::size_t c = 0; c < columns; ++c) {
    const auto fitting = [&](std::size_t k) { return counts[k][c] == least[c]; };
    chosen.push_back(by_column(candidates[*std::find_if(order.begin(), order.end(), fitting)], c));
  }
  return chosen;
}

}  // namespace mocapress
