// Prints JSON, in which the module for motion files says what it read.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mocapress::wasm {

class Json {
 public:
  // Of a text in UTF-8, in which surrogates may stand alone; these are escaped.
  Json& text(std::string_view utf8) {
    begin();
    out_ += '"';
    for (std::size_t at = 0; at < utf8.size(); ++at) {
      const auto byte = static_cast<unsigned char>(utf8[at]);
      if (byte == 0xED && at + 2 < utf8.size() &&
          static_cast<unsigned char>(utf8[at + 1]) >= 0xA0) {
        escape(0xD000u | (static_cast<unsigned>(utf8[at + 1]) & 0x3Fu) << 6 |
               (static_cast<unsigned>(utf8[at + 2]) & 0x3Fu));
        at += 2;
      } else if (byte < 0x20 || byte == '"' || byte == '\\') {
        escape(byte);
      } else {
        out_ += utf8[at];
      }
    }
    out_ += '"';
    return *this;
  }

  Json& whole(std::int64_t value) { return word(std::to_string(value)); }

  Json& word(std::string_view literal) {
    begin();
    out_ += literal;
    return *this;
  }

  Json& key(std::string_view name) {
    text(name);
    out_ += ':';
    first_ = true;
    return *this;
  }

  Json& open(char bracket) {
    begin();
    out_ += bracket;
    first_ = true;
    return *this;
  }

  Json& close(char bracket) {
    out_ += bracket;
    first_ = false;
    return *this;
  }

  // Items of a list, each printed by `print`.
  template <class Items, class Print>
  Json& list(const Items& items, Print print) {
    open('[');
    for (const auto& item : items) print(item);
    return close(']');
  }

  const std::string& printed() const { return out_; }

 private:
  void begin() {
    if (!first_) out_ += ',';
    first_ = false;
  }

  void escape(unsigned code) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    out_ += "\\u";
    for (int shift = 12; shift >= 0; shift -= 4) out_ += kDigits[code >> shift & 15];
  }

  std::string out_;
  bool first_ = true;
};

}  // namespace mocapress::wasm
