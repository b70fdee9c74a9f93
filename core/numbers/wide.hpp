// For functions that are there twice: for registers that all machines have, and, marked, for twice
// as wide ones, where the machine is found to have them when the program runs. Both must give the
// same bits.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && defined(__linux__) && !defined(__clang__) && \
    !defined(MOCAPRESS_NO_CLONES)
#define MOCAPRESS_WIDE __attribute__((target("avx2,bmi,bmi2,lzcnt")))
#else
#define MOCAPRESS_WIDE
#endif

namespace mocapress {

inline bool is_wide() {
#if defined(__x86_64__) && defined(__GNUC__) && defined(__linux__) && !defined(__clang__) && \
    !defined(MOCAPRESS_NO_CLONES)
  static const bool kWide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2");
  return kWide;
#else
  return false;
#endif
}

}  // namespace mocapress
