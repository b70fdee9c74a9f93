// Marks a function to be compiled for several instruction sets, the best of which is chosen when
// the library is loaded. All give the same bits: loops work element by element, and products are
// never fused with sums (-ffp-contract=off).
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && defined(__linux__) && !defined(__clang__) && \
    !defined(MOCAPRESS_NO_CLONES)
#define MOCAPRESS_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define MOCAPRESS_VECTOR_CLONES
#endif
