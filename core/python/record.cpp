// Python's view of coding/record.hpp: many integers at a time.
#include "coding/record.hpp"

#include <nanobind/stl/tuple.h>

#include <stdexcept>

#include "python/bindings.hpp"

namespace mocapress {
namespace {

std::tuple<Given<std::uint64_t>, std::size_t> read_integers(const nb::bytes& data,
                                                            std::size_t begin, std::size_t count) {
  if (begin > data.size() || count > data.size() - begin)
    throw std::invalid_argument("more integers than a record holds");
  Record record(view(data).subspan(begin));
  std::vector<std::uint64_t> numbers(count);
  for (auto& number : numbers) number = record.integer();
  return {give(std::move(numbers)), data.size() - record.left()};
}

nb::bytes write_integers(const Input<std::uint64_t, 1>& numbers) {
  Bytes made;
  for (std::size_t i = 0; i < numbers.shape(0); ++i) {
    std::uint64_t number = numbers.data()[i];
    for (; number > 0x7F; number >>= 7) made.push_back(static_cast<std::uint8_t>(number | 0x80));
    made.push_back(static_cast<std::uint8_t>(number));
  }
  return to_python(made);
}

}  // namespace

void bind_record(nb::module_& module) {
  module.def("read_integers", &read_integers, nb::arg("data"), nb::arg("begin"), nb::arg("count"),
             "Read so many integers, as docs/format.md has them; give them, (N,), and their end.");
  module.def("write_integers", &write_integers, nb::arg("numbers"), "Write integers, (N,).");
}

}  // namespace mocapress
