#include "search/search.hpp"

namespace mocapress {

void scan_signatures(const std::int8_t* wanted, const std::int8_t* others, std::size_t count,
                     std::size_t size, std::int32_t* distances) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int8_t* const other = others + i * size;
    std::int32_t sum = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const auto apart = static_cast<std::int16_t>(wanted[k] - other[k]);
      sum += apart * apart;
    }
    distances[i] = sum;
  }
}

}  // namespace mocapress
