#include "wasm/space.hpp"

#include <cstddef>
#include <string>

namespace mocapress::wasm {

std::vector<double>& space() {
  static std::vector<double> memory;
  return memory;
}

}  // namespace mocapress::wasm

// Where so many bytes are to be written; good until the next call.
extern "C" [[clang::export_name("space")]] void* mocapress_space(std::size_t size) {
  auto& space = mocapress::wasm::space();
  space.resize(size / sizeof(double) + 1);
  return space.data();
}

// What the standard library calls where it would print a message and abort; printing is large.
namespace std::inline __1 {
[[noreturn]] void __libcpp_verbose_abort(const char*, ...) noexcept { __builtin_trap(); }
}  // namespace std::inline __1
