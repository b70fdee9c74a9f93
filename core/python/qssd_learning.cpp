// Python's view of qssd_learning/.
#include <nanobind/stl/pair.h>

#include <utility>
#include <vector>

#include "python/bindings.hpp"
#include "qssd_learning/products.hpp"
#include "qssd_learning/sparse.hpp"
#include "qssd_learning/sums.hpp"

namespace mocapress {
namespace {

using Picks = std::pair<Given<std::int32_t, 2>, Given<double, 2>>;

void check(bool right, const char* what) {
  if (!right) throw nb::value_error(what);
}

void check_picks(const Output<std::int32_t, 2>& atoms, const Output<double, 2>& weights,
                 std::size_t frames, std::size_t known) {
  check(atoms.shape(0) == frames && weights.shape(0) == frames, "weights of other frames");
  check(atoms.shape(1) == weights.shape(1) && atoms.shape(1) <= qssd::kMostAtoms,
        "atoms and weights of other shapes");
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const std::int32_t atom = atoms.data()[i];
    check(atom >= -1 && atom < static_cast<std::int64_t>(known), "an atom that does not exist");
  }
}

qssd::Frames frames_of(const Input<double, 3>& turns, const Input<double, 1>& importance) {
  check(turns.shape(2) == 4 && importance.shape(0) == turns.shape(1),
        "quaternions of other joints");
  return {turns.data(), turns.shape(0), turns.shape(1), importance.data()};
}

// Room for the picks of so many frames.
template <class Work>
Picks picks(std::size_t frames, std::size_t most, const Work& work) {
  check(most <= qssd::kMostAtoms, "more atoms of a frame than there can be");
  std::vector<std::int32_t> atoms(frames * most, -1);
  std::vector<double> weights(frames * most);
  {
    const nb::gil_scoped_release release;
    work(qssd::Weights{atoms.data(), weights.data(), most});
  }
  const std::array shape{frames, most};
  return {give(std::move(atoms), shape), give(std::move(weights), shape)};
}

Picks code_by_products(const Input<double, 3>& turns, const Input<double, 1>& importance,
                       const Input<double, 3>& dictionary, std::size_t most, double tolerance,
                       double least, bool sorted) {
  const auto frames = frames_of(turns, importance);
  check(dictionary.shape(1) == frames.joints && dictionary.shape(2) == 3, "atoms of other joints");
  return picks(frames.frames, most, [&](const qssd::Weights& weights) {
    // The kernel only reads them.
    const qssd::Dictionary atoms{const_cast<double*>(dictionary.data()), dictionary.shape(0)};
    qssd::code_by_products(frames, atoms, weights, {tolerance, least},
                           sorted ? qssd::Order::sort : qssd::Order::stop);
  });
}

void quantize_products(const Input<double, 3>& turns, const Input<double, 1>& importance,
                       const Input<double, 3>& dictionary, const Output<std::int32_t, 2>& atoms,
                       const Output<double, 2>& weights, double step, double rounding) {
  const auto frames = frames_of(turns, importance);
  check(dictionary.shape(1) == frames.joints && dictionary.shape(2) == 3, "atoms of other joints");
  check_picks(atoms, weights, frames.frames, dictionary.shape(0));
  check(step > 0, "a step that is no number above 0");
  const nb::gil_scoped_release release;
  qssd::quantize_products(frames, {const_cast<double*>(dictionary.data()), dictionary.shape(0)},
                          {atoms.data(), weights.data(), atoms.shape(1)}, step, rounding);
}

void learn_products(const Input<double, 3>& turns, const Input<double, 1>& importance,
                    const Output<double, 3>& dictionary, const Output<std::int32_t, 2>& atoms,
                    const Output<double, 2>& weights) {
  const auto frames = frames_of(turns, importance);
  check(dictionary.shape(1) == frames.joints && dictionary.shape(2) == 3, "atoms of other joints");
  check_picks(atoms, weights, frames.frames, dictionary.shape(0));
  const nb::gil_scoped_release release;
  qssd::learn_products(frames, {dictionary.data(), dictionary.shape(0)},
                       {atoms.data(), weights.data(), atoms.shape(1)});
}

Given<double, 3> combine_products(const Output<double, 3>& dictionary,
                                  const Output<std::int32_t, 2>& atoms,
                                  const Output<double, 2>& weights) {
  const std::size_t frames = atoms.shape(0), joints = dictionary.shape(1);
  check(dictionary.shape(2) == 3, "atoms of other joints");
  check_picks(atoms, weights, frames, dictionary.shape(0));
  std::vector<double> turns(frames * joints * 4);
  {
    const nb::gil_scoped_release release;
    qssd::combine_products(turns.data(), frames, joints, {dictionary.data(), dictionary.shape(0)},
                           {atoms.data(), weights.data(), atoms.shape(1)});
  }
  return give(std::move(turns), std::array{frames, joints, std::size_t{4}});
}

Picks code_by_sums(const Input<double, 2>& rows, const Input<double, 2>& dictionary,
                   std::size_t most, double tolerance) {
  check(rows.shape(1) == dictionary.shape(1), "atoms of other rows");
  return picks(rows.shape(0), most, [&](const qssd::Weights& weights) {
    const qssd::Dictionary atoms{const_cast<double*>(dictionary.data()), dictionary.shape(0)};
    qssd::code_by_sums(rows.data(), rows.shape(0), rows.shape(1), atoms, weights, tolerance);
  });
}

void learn_sums(const Input<double, 2>& rows, const Output<double, 2>& dictionary,
                const Output<std::int32_t, 2>& atoms, const Output<double, 2>& weights) {
  check(rows.shape(1) == dictionary.shape(1), "atoms of other rows");
  check_picks(atoms, weights, rows.shape(0), dictionary.shape(0));
  const nb::gil_scoped_release release;
  qssd::learn_sums(rows.data(), rows.shape(0), rows.shape(1),
                   {dictionary.data(), dictionary.shape(0)},
                   {atoms.data(), weights.data(), atoms.shape(1)});
}

}  // namespace

void bind_qssd_learning(nb::module_& module) {
  module.def("code_by_products", &code_by_products, nb::arg("turns"), nb::arg("importance"),
             nb::arg("dictionary"), nb::arg("most"), nb::arg("tolerance"), nb::arg("least"),
             nb::arg("sorted"),
             "Code frames, (F, J, 4), by atoms, (K, J, 3): Algorithm 2.\n\n"
             "Gives each frame's atoms, (F, most), -1 behind the last, and their weights.");
  module.def("quantize_products", &quantize_products, nb::arg("turns"), nb::arg("importance"),
             nb::arg("dictionary"), nb::arg("atoms").noconvert(), nb::arg("weights").noconvert(),
             nb::arg("step"), nb::arg("rounding"),
             "Make ``weights`` multiples of ``step``, each the best beside the others, in place.");
  module.def("learn_products", &learn_products, nb::arg("turns"), nb::arg("importance"),
             nb::arg("dictionary").noconvert(), nb::arg("atoms").noconvert(),
             nb::arg("weights").noconvert(),
             "Improve ``dictionary`` and ``weights`` in place: Algorithm 3.");
  module.def("combine_products", &combine_products, nb::arg("dictionary"), nb::arg("atoms"),
             nb::arg("weights"), "Give the products of atoms, (F, J, 4): Eq. 3.");
  module.def("code_by_sums", &code_by_sums, nb::arg("rows"), nb::arg("dictionary"), nb::arg("most"),
             nb::arg("tolerance"),
             "Code rows, (F, C), by atoms, (K, C), of length 1: orthogonal matching pursuit.");
  module.def("learn_sums", &learn_sums, nb::arg("rows"), nb::arg("dictionary").noconvert(),
             nb::arg("atoms").noconvert(), nb::arg("weights").noconvert(),
             "Improve ``dictionary`` and ``weights`` in place: Algorithm 1.");
}

}  // namespace mocapress
