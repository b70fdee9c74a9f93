// For functions that are there twice: for registers that all machines have, and, marked, for twice
// as wide ones, where the machine is found to have them when the program runs. Both must give the
// same bits.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && defined(__linux__) && !defined(__clang__) && \
    !defined(MOCAPRESS_NO_CLONES)
#define MOCAPRESS_WIDE __attribute__((target("avx2,bmi,bmi2,lzcnt")))
#define MOCAPRESS_MAY_BE_WIDE 1
#else
#define MOCAPRESS_WIDE
#define MOCAPRESS_MAY_BE_WIDE 0
#endif

// Compiles all that a function calls in place. It does nothing in builds for fuzzing and checking,
// where it would cost the compiler minutes.
#if defined(FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION) || defined(MOCAPRESS_NO_CLONES)
#define MOCAPRESS_FLATTEN
#else
#define MOCAPRESS_FLATTEN [[gnu::flatten]]
#endif

namespace mocapress {

// Whether wide functions are there at all: where they are not, `if constexpr` spares the compiler
// those that are templates.
inline constexpr bool kMayBeWide = MOCAPRESS_MAY_BE_WIDE != 0;

inline bool is_wide() {
#if MOCAPRESS_MAY_BE_WIDE
  static const bool kWide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2");
  return kWide;
#else
  return false;
#endif
}

}  // namespace mocapress
