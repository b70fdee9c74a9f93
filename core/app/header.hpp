// The codec header of `app`: parent and precision of every column (docs/format.md, "app").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/codec.hpp"
#include "coding/bit.hpp"
#include "coding/record.hpp"
#include "numbers/text.hpp"

namespace mocapress::app {

// The columns of a clip whose source printed them in these formats. `fail`s where the header is not
// one of so many columns.
std::vector<Column> read_header(ByteView header, std::span<const NumberFormat> formats);

// Each column's parent, as the header begins with them.
std::vector<std::int32_t> read_parents(Record& record, std::size_t columns);

// A column without a parent, of a precision as headers have it.
Column column_of(const NumberFormat& format, std::uint64_t precision);

}  // namespace mocapress::app
