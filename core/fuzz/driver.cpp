// Runs a fuzz target where libFuzzer is not at hand:
//   driver FILE...           runs every file
//   driver [FILE...] -runs=N  besides, N mutations of the files, or of bytes at random without any
// The mutations of a run follow from a number that it prints, and takes as -seed=N. `make sanitize`
// builds and runs all targets; libFuzzer takes the same options, and no driver.cpp.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;  // gives the same numbers with every compiler; distributions do not

constexpr std::size_t kLongest = 4096;

Bytes noise(Random& random) {
  Bytes bytes(random() % kLongest);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

void mutate(Bytes& bytes, Random& random) {
  if (bytes.empty()) {
    bytes = noise(random);
    return;
  }
  const std::size_t at = random() % bytes.size();
  const auto position = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  switch (random() % 5) {
    case 0:
      bytes[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
      break;
    case 1:
      bytes[at] = static_cast<std::uint8_t>(random());
      break;
    case 2:
      bytes.resize(at);
      break;
    case 3:
      bytes.insert(position, static_cast<std::uint8_t>(random()));
      break;
    default:
      bytes.erase(position);
  }
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<Bytes> seeds;
  unsigned long runs = 0;
  unsigned long seed = std::random_device{}();
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument.starts_with("-runs=")) {
      runs = std::stoul(argument.substr(6));
      continue;
    }
    if (argument.starts_with("-seed=")) {
      seed = std::stoul(argument.substr(6));
      continue;
    }
    std::ifstream file(argument, std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "cannot read %s\n", arguments[i]);
      return 1;
    }
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    LLVMFuzzerTestOneInput(seeds.back().data(), seeds.back().size());
  }
  std::printf("-runs=%lu -seed=%lu\n", runs, seed);
  std::fflush(stdout);
  Random random(seed);
  for (unsigned long run = 0; run < runs; ++run) {
    Bytes bytes = seeds.empty() ? noise(random) : seeds[run % seeds.size()];
    for (auto times = random() % 4; times-- > 0;) mutate(bytes, random);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%zu files and %lu mutations passed\n", seeds.size(), runs);
  return 0;
}
