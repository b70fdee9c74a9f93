// How the kernels give up on what they are told: natively an exception, in WebAssembly, which has
// none, a function of the page, which throws and never uses this instance again.
#pragma once

#ifdef __wasm__
#include <string_view>
#else
#include <stdexcept>
#endif

namespace mocapress {

#ifdef __wasm__

extern "C" [[noreturn, clang::import_module("page"),
             clang::import_name("fail")]] void mocapress_fail(const char* what, std::size_t size);

[[noreturn]] inline void fail(std::string_view what) { mocapress_fail(what.data(), what.size()); }

#else

// Throws std::invalid_argument.
[[noreturn]] inline void fail(const char* what) { throw std::invalid_argument(what); }

#endif

}  // namespace mocapress
