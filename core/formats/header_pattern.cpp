#include "formats/header_pattern.hpp"

#include <algorithm>
#include <set>

#include "formats/text.hpp"

namespace mocapress {
namespace {

// The bytes of a pattern that stand for something else.
enum Code : unsigned char {
  kRaw = 0,
  kBreak = 1,
  kName = 2,
  kChannels = 3,
  kCount = 4,
  kTime = 5,
  kPass = 6,
  kNumber = 0x10,
};

constexpr std::size_t kMostFormats = 16;

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 && c != '\t' && c != '\n' && c != '\r';
}

void append_raw(std::string& out, std::string_view text) {
  for (const char c : text) {
    if (is_control(c)) out += static_cast<char>(kRaw);
    out += c;
  }
}

std::int64_t braces(std::string_view text) {
  std::int64_t depth = 0;
  for (const char c : text) depth += c == '{' ? 1 : c == '}' ? -1 : 0;
  return depth;
}

const std::string* word_at(const std::vector<std::optional<std::string>>& words,
                           std::size_t index) {
  if (index >= words.size()) return nullptr;
  const std::optional<std::string>& word = words[index];
  return word ? &*word : nullptr;
}

std::string printed(double value, const NumberFormat& format) {
  char text[kLongestNumber];
  return std::string(text, print_number(text, value, format));
}

// A part of the header that may be referred to.
struct Mark {
  std::size_t begin, end;
  Code code;
};

class Marks {
 public:
  explicit Marks(std::string_view header) : header_(header) {
    for (std::size_t at = 0; at < header.size(); at = next_line(header, std::max(at_, at))) {
      at_ = at;
      skip();
      line();
    }
  }
  std::vector<Mark> found;

 private:
  std::string_view header_;
  std::size_t at_ = 0;

  bool skip() {
    const std::size_t begin = at_;
    while (at_ < header_.size() && (header_[at_] == ' ' || header_[at_] == '\t')) ++at_;
    return at_ > begin;
  }
  bool word(std::string_view lower_case) {
    if (!same_word(header_.substr(at_, lower_case.size()), lower_case)) return false;
    at_ += lower_case.size();
    return true;
  }
  template <class Is>
  bool take(Code code, Is is) {
    const std::size_t begin = at_;
    while (at_ < header_.size() && is(header_[at_])) ++at_;
    if (at_ > begin) found.push_back({begin, at_, code});
    return at_ > begin;
  }
  void line() {
    const auto in_line = [](char c) { return !is_line_end(c); };
    const auto plain = [](char c) { return !is_space(c) && c != '{' && c != '}'; };
    const std::size_t before = found.size();
    if (word("root") || word("joint")) {
      if (skip()) take(kName, in_line);
    } else if (word("offset")) {
      bool good = true;
      for (int k = 0; k < 3 && good; ++k) good = skip() && take(kNumber, plain);
      if (!good) found.resize(before);
    } else if (word("channels")) {
      const auto listed = [](char c) { return !is_line_end(c) && c != '{' && c != '}'; };
      if (skip() && take(kChannels, listed)) {
        Mark& mark = found.back();
        while (mark.end > mark.begin && is_space(header_[mark.end - 1])) --mark.end;
        if (mark.end == mark.begin) found.pop_back();
      }
    } else if (word("frames")) {
      skip();
      if (!word(":")) return;
      skip();
      take(kCount, is_digit);
    } else if (word("frame")) {
      if (!skip() || !word("time")) return;
      skip();
      if (!word(":")) return;
      skip();
      take(kTime, [](char c) { return !is_space(c); });
    }
  }
};

// How many decimals a plain number has, or nothing.
std::optional<std::size_t> decimals_of(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  const std::size_t point = text.find('.');
  for (std::size_t i = 0; i < text.size(); ++i)
    if (i != point && !is_digit(text[i])) return {};
  return point == std::string_view::npos ? 0 : text.size() - point - 1;
}

// The formats that print most of the numbers, the best first.
std::vector<NumberFormat> formats_of(const std::vector<std::string_view>& texts,
                                     const std::vector<double>& values) {
  std::set<std::size_t> decimals;
  for (const std::string_view text : texts) {
    const auto count = decimals_of(text);
    if (count && *count <= kMostDigits) decimals.insert(*count);
  }
  std::vector<NumberFormat> candidates;
  candidates.reserve(decimals.size());
  for (const std::size_t count : decimals)
    candidates.push_back({NumberKind::fixed, static_cast<std::uint8_t>(count)});
  if (candidates.size() > 2) {
    const auto most = static_cast<std::uint8_t>(*decimals.rbegin());
    candidates.insert(candidates.end(), {{NumberKind::trimmed, most},
                                         {NumberKind::trimmed, most, 2, true},
                                         {NumberKind::general, 6},
                                         {NumberKind::general, 9},
                                         {NumberKind::shortest, 0},
                                         {NumberKind::shortest, 0, 2, true}});
  }
  std::vector<std::vector<bool>> fits;
  for (const NumberFormat& candidate : candidates) {
    std::vector<bool>& fitting = fits.emplace_back(texts.size());
    for (std::size_t i = 0; i < texts.size(); ++i)
      fitting[i] = printed(values[i], candidate) == texts[i];
  }
  std::vector<NumberFormat> chosen;
  std::vector<bool> left(texts.size(), true);
  while (chosen.size() < kMostFormats) {
    std::size_t best = 0;
    std::size_t most = 0;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      std::size_t count = 0;
      for (std::size_t i = 0; i < left.size(); ++i) count += left[i] && fits[k][i];
      if (count > most) best = k, most = count;
    }
    if (most == 0) break;
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = left[i] && !fits[best][i];
    chosen.push_back(candidates[best]);
  }
  return chosen;
}

// Builds the pattern of a header whose marks are known.
class Builder {
 public:
  Builder(std::string_view header, const HeaderReferences& refer, const HeaderStyle& style)
      : header_(header), refer_(refer), style_(style) {}

  std::string pattern(const std::vector<Mark>& marks) {
    for (Mark mark : marks) {
      std::string reference(1, static_cast<char>(mark.code));
      const bool same = refers(mark, reference);
      append_broken(header_.substr(position_, mark.begin - position_));
      const std::string_view text = header_.substr(mark.begin, mark.end - mark.begin);
      depth_ += braces(text);
      if (same) {
        out_ += reference;
      } else {
        append_raw(out_, text);
      }
      position_ = mark.end;
    }
    append_broken(header_.substr(position_));
    return std::move(out_);
  }

 private:
  std::string_view header_;
  const HeaderReferences& refer_;
  const HeaderStyle& style_;
  std::string out_;
  std::size_t position_ = 0;
  std::size_t joints_ = 0;  // named so far
  std::size_t numbers_ = 0;
  std::int64_t depth_ = 0;

  // Whether a reference prints what stands there; a name may be followed by more.
  bool refers(Mark& mark, std::string& reference) {
    const std::string_view text = header_.substr(mark.begin, mark.end - mark.begin);
    switch (mark.code) {
      case kName: {
        const std::size_t joint = joints_++;
        const std::string* const name = word_at(refer_.names, joint);
        if (name == nullptr || !text.starts_with(*name)) return false;
        mark.end = mark.begin + name->size();
        return true;
      }
      case kChannels: {
        const std::string* const words =
            joints_ > 0 ? word_at(refer_.channels, joints_ - 1) : nullptr;
        return words != nullptr && *words == text;
      }
      case kNumber: {
        const double value = refer_.numbers[numbers_++];
        for (std::size_t k = 0; k < style_.formats.size(); ++k) {
          if (printed(value, style_.formats[k]) != text) continue;
          reference[0] = static_cast<char>(kNumber + k);
          return true;
        }
        reference[0] = static_cast<char>(kPass);
        append_raw(reference, text);
        return true;
      }
      case kCount:
        return text == std::to_string(refer_.rows);
      default:
        return !refer_.time.empty() && text == refer_.time;
    }
  }

  // Appends a text, with references for its line breaks and the indentation behind them.
  void append_broken(std::string_view text) {
    for (bool first = true;; first = false) {
      const std::size_t end = text.find(style_.line_break);
      const std::string_view line = text.substr(0, end);
      if (first) {
        append_raw(out_, line);
      } else {
        append_line(line);
      }
      depth_ += braces(line);
      if (end == std::string_view::npos) return;
      text.remove_prefix(end + style_.line_break.size());
    }
  }
  void append_line(std::string_view line) {
    const std::size_t content = line.find_first_not_of(" \t");
    const bool closes = content != std::string_view::npos && line[content] == '}';
    const std::int64_t open = style_.indentation.empty() ? 0 : depth_ - (closes ? 1 : 0);
    const auto steps = static_cast<std::size_t>(std::max<std::int64_t>(open, 0));
    std::string_view rest = line;
    std::size_t passed = 0;
    for (; passed < steps && rest.starts_with(style_.indentation); ++passed)
      rest.remove_prefix(style_.indentation.size());
    if (passed == steps && rest.starts_with('}') == closes) {
      out_ += static_cast<char>(kBreak);
      append_raw(out_, rest);
    } else {
      out_ += style_.line_break;
      append_raw(out_, line);
    }
  }
};

}  // namespace

std::pair<std::string, std::vector<NumberFormat>> header_pattern(std::string_view header,
                                                                 const HeaderReferences& refer,
                                                                 const HeaderStyle& style) {
  std::vector<Mark> marks = Marks(header).found;
  std::vector<std::string_view> numbers;
  for (const Mark& mark : marks)
    if (mark.code == kNumber) numbers.push_back(header.substr(mark.begin, mark.end - mark.begin));
  const auto prints = [&](const std::string& pattern, const HeaderStyle& in_style) {
    const char* why = nullptr;
    const auto back = print_header(pattern, refer, in_style, header.size(), why);
    return back && *back == header;
  };
  if (!refer.names.empty() && numbers.size() == refer.numbers.size()) {
    HeaderStyle fitted = style;
    fitted.formats = formats_of(numbers, refer.numbers);
    std::string pattern = Builder(header, refer, fitted).pattern(marks);
    if (prints(pattern, fitted)) return std::pair(std::move(pattern), std::move(fitted.formats));
  }
  std::erase_if(marks, [](const Mark& mark) { return mark.code != kCount && mark.code != kTime; });
  HeaderStyle plain = style;
  plain.formats.clear();
  std::string pattern = Builder(header, refer, plain).pattern(marks);
  if (prints(pattern, plain)) return std::pair(std::move(pattern), std::vector<NumberFormat>());
  pattern.clear();
  append_raw(pattern, header);
  return std::pair(std::move(pattern), std::vector<NumberFormat>());
}

std::optional<std::string> print_header(std::string_view pattern, const HeaderReferences& refer,
                                        const HeaderStyle& style, std::uint64_t most,
                                        const char*& why) {
  std::string out;
  std::int64_t depth = 0;
  std::size_t joint = 0;  // how many were named
  std::size_t number = 0;
  const auto fail = [&](const char* reason) {
    why = reason;
    return std::optional<std::string>();
  };
  const auto put = [&](std::string_view text) {
    out += text;
    depth += braces(text);
  };
  constexpr auto kMissing = "a pattern refers to what is not there";
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    const char c = pattern[at];
    const auto code = static_cast<unsigned char>(c);
    if (!is_control(c)) {
      out += c;
      depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    } else if (code == kRaw) {
      if (++at == pattern.size()) return fail("a pattern cut off");
      put(pattern.substr(at, 1));
    } else if (code == kBreak) {
      const bool closes = at + 1 < pattern.size() && pattern[at + 1] == '}';
      out += style.line_break;
      const std::int64_t steps = style.indentation.empty() ? 0 : depth - (closes ? 1 : 0);
      for (std::int64_t step = 0; step < steps && out.size() <= most; ++step)
        out += style.indentation;
    } else if (code >= kNumber || code == kPass) {
      if (number >= refer.numbers.size()) return fail("more numbers than the skeleton has");
      const double value = refer.numbers[number++];
      if (code >= kNumber) {
        const std::size_t k = code - kNumber;
        if (k >= style.formats.size()) return fail("a number in no format");
        out += printed(value, style.formats[k]);
      }
    } else if (code == kName) {
      const std::string* const name = word_at(refer.names, joint);
      if (name == nullptr) return fail(kMissing);
      put(*name);
      ++joint;
    } else if (code == kChannels) {
      const std::string* const words = joint > 0 ? word_at(refer.channels, joint - 1) : nullptr;
      if (words == nullptr) return fail(kMissing);
      out += *words;
    } else if (code == kCount) {
      out += std::to_string(refer.rows);
    } else if (code == kTime && !refer.time.empty()) {
      out += refer.time;
    } else {
      return fail(kMissing);
    }
    if (out.size() > most) return fail("a longer header than may be");
  }
  return out;
}

}  // namespace mocapress
