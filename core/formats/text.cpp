#include "formats/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "numbers/text.hpp"

namespace mocapress {
namespace {

constexpr std::size_t kLongestFound = 40;
// Of a number that a header states.
constexpr std::size_t kMostStatedDigits = 100;
constexpr std::int64_t kMostStatedSize = 18;

void append_utf8(std::string& out, std::uint32_t code) {
  const auto byte = [&](std::uint32_t value) { out += static_cast<char>(value); };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xC0 | code >> 6);
    byte(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    byte(0xE0 | code >> 12);
    byte(0x80 | (code >> 6 & 0x3F));
    byte(0x80 | (code & 0x3F));
  } else {
    byte(0xF0 | code >> 18);
    byte(0x80 | (code >> 12 & 0x3F));
    byte(0x80 | (code >> 6 & 0x3F));
    byte(0x80 | (code & 0x3F));
  }
}

// The length of the UTF-8 sequence at an index, 0 where there is none; surrogates pass.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[at + k]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || at + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xC0) != 0x80) return 0;
  // Longer than needed, or beyond the last character.
  if (first == 0xE0 && byte(1) < 0xA0) return 0;
  if (first == 0xF0 && byte(1) < 0x90) return 0;
  if (first == 0xF4 && byte(1) > 0x8F) return 0;
  return length;
}

std::string utf8_of(std::string_view bytes) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t length = utf8_length(bytes, at);
    if (length == 0) break;
    at += length;
  }
  if (at == bytes.size()) return std::string(bytes);
  std::string out;
  for (const char c : bytes) append_utf8(out, static_cast<unsigned char>(c));
  return out;
}

int hexadecimal(char c) { return is_digit(c) ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1; }

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = at;
    while (at < text.size() && !is_space(text[at])) ++at;
    if (at > begin) words.push_back(text.substr(begin, at - begin));
    while (at < text.size() && is_space(text[at])) ++at;
  }
  return words;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

bool same_word(std::string_view text, std::string_view lower_case) {
  return text.size() == lower_case.size() && lower(text) == lower_case;
}

std::uint64_t line_of(std::string_view text, std::size_t offset) {
  std::uint64_t line = 1;
  for (std::size_t i = 0; i < std::min(offset, text.size()); ++i) {
    const bool half = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    line += is_line_end(text[i]) && !half;
  }
  return line;
}

std::size_t end_of_line(std::string_view text, std::size_t offset) {
  while (offset < text.size() && !is_line_end(text[offset])) ++offset;
  return offset;
}

std::size_t next_line(std::string_view text, std::size_t offset) {
  offset = end_of_line(text, offset);
  if (offset < text.size() && text[offset] == '\r') ++offset;
  if (offset < text.size() && text[offset] == '\n') ++offset;
  return offset;
}

bool is_padding(std::string_view rest) {
  return std::all_of(rest.begin(), rest.end(),
                     [](char c) { return is_space(c) || c == '\0' || c == '\x1a'; });
}

std::optional<std::string> from_utf16(std::string_view bytes) {
  if (bytes.size() % 2 != 0 || bytes.size() < 2) return {};
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  const bool little = byte(0) == 0xFF && byte(1) == 0xFE;
  if (!little && !(byte(0) == 0xFE && byte(1) == 0xFF)) return {};
  const auto unit = [&](std::size_t at) {
    return static_cast<std::uint32_t>(little ? byte(at) | byte(at + 1) << 8
                                             : byte(at) << 8 | byte(at + 1));
  };
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t at = 2; at < bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (code >= 0xD800 && code < 0xE000) {
      const bool pair = code < 0xDC00 && at + 2 < bytes.size() && (unit(at + 2) & 0xFC00) == 0xDC00;
      if (!pair) return {};
      at += 2;
      code = 0x10000 + ((code & 0x3FF) << 10) + (unit(at) & 0x3FF);
    }
    append_utf8(out, code);
  }
  return out;
}

std::string shown(std::string_view text) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  const std::string utf8 = utf8_of(text);
  for (std::size_t at = 0; at < utf8.size(); ++at) {
    const char c = utf8[at];
    auto byte = static_cast<unsigned char>(c);
    // Those of ISO 8859-1 have two bytes in UTF-8.
    const bool upper = byte == 0xC2 && at + 1 < utf8.size() && utf8[at + 1] < '\xa0';
    if (upper) byte = static_cast<unsigned char>(utf8[++at]);
    if (c == '\n' || c == '\r' || c == '\t') {
      out += c == '\n' ? "\\n" : c == '\r' ? "\\r" : "\\t";
    } else if (byte < 0x20 || byte == 0x7F || upper) {
      out += "\\x";
      out += kDigits[byte >> 4];
      out += kDigits[byte & 15];
    } else {
      if (c == '\\') out += '\\';
      out += c;
    }
  }
  return out;
}

std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : shown(text)) {
    if (c == '\'') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string found_at(std::string_view text, std::size_t offset) {
  while (offset < text.size() && is_blank(text[offset])) ++offset;
  if (offset >= text.size()) return "the end of the file";
  if (is_line_end(text[offset])) return "the end of the line";
  const auto words = words_of(text.substr(offset, kLongestFound));
  return quoted(words.front());
}

std::string decoded_name(std::string_view raw) {
  std::string bytes;
  for (std::size_t at = 0; at < raw.size();) {
    const auto digit = [&](std::size_t k) {
      return at + k < raw.size() ? hexadecimal(raw[at + k]) : -1;
    };
    if (raw[at] == '%' && digit(1) >= 0 && digit(2) >= 0) {
      bytes += static_cast<char>(digit(1) * 16 + digit(2));
      at += 3;
    } else if (raw[at] == '%' && at + 1 < raw.size() && raw[at + 1] == '.') {
      at += 2;
      while (at < raw.size() && is_digit(raw[at])) ++at;
    } else {
      bytes += raw[at++];
    }
  }
  return utf8_of(bytes);
}

std::optional<std::string> stated_number(std::string_view text, double& value) {
  const char* p = text.data();
  const char* const end = p + text.size();
  const bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) ++p;
  const char* const start = p;
  std::size_t digits = 0;  // from the first that is not zero
  std::int64_t decimals = 0;
  bool any = false;
  bool point = false;
  for (; p < end && (is_digit(*p) || (*p == '.' && !point)); ++p) {
    if (*p == '.') {
      point = true;
      continue;
    }
    any = true;
    decimals += point;
    digits += digits > 0 || *p != '0';
  }
  std::int64_t exponent = 0;
  if (any && p < end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    const bool down = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+')) ++q;
    for (any = false; q < end && is_digit(*q); ++q, any = true)
      exponent = std::min<std::int64_t>(exponent * 10 + (*q - '0'), 1'000'000);
    if (down) exponent = -exponent;
    p = q;
  }
  if (!any || p != end || digits > kMostStatedDigits) return {};
  const std::int64_t size =
      exponent - decimals + static_cast<std::int64_t>(std::max<std::size_t>(digits, 1)) - 1;
  if (size <= -kMostStatedSize || size >= kMostStatedSize || (negative && digits > 0)) return {};
  NumberShape shape;
  if (parse_number(start, end, value, shape) != end) return {};
  return std::string(start, end);
}

std::optional<double> finite_number(std::string_view text) {
  double value = 0;
  NumberShape shape;
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  if (parse_number(begin, end, value, shape) != end || !std::isfinite(value)) return {};
  return value;
}

}  // namespace mocapress
