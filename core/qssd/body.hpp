// What a clip's columns are to the codec `qssd`: turns of joints, and numbers
// (docs/format/qssd.md).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "coding/record.hpp"
#include "qssd/quaternion.hpp"

namespace mocapress::qssd {

struct JointTurns {
  std::vector<std::size_t> columns;  // one to three, of different axes
  std::vector<std::size_t> axes;
  double importance = 1;  // how far the body moves where it turns by half an angle of 1 radian
  Quaternion reference = kNoTurn;
};

struct Number {
  std::size_t column;
  double importance = 1;
  double reference = 0;
};

struct Body {
  std::size_t columns = 0;
  bool reversed = false;  // a joint's last turn stands first in the product (ASF)
  bool radians = false;
  std::vector<JointTurns> joints;
  std::vector<Number> numbers;

  // The turn of a joint in a row of columns.
  Quaternion turn(const JointTurns& joint, const double* row) const;
  // The other way round: fills a joint's columns of a row, near to those of the row before where
  // there is one.
  void angles(const JointTurns& joint, const Quaternion& turn, const double* before,
              double* row) const;
};

Body read_body(Record& record);

}  // namespace mocapress::qssd
