#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "lambake/core/error.h"
#include "lambake/core/finding.h"
#include "lambake/io/ply_header.h"
#include "lambake/io/text_cursor.h"

/// The values of a PLY behind its header, one by one.
namespace lambake {

/// Values of an ASCII body. Like every reader of PLY it takes line ends for blanks.
class AsciiPlyBody {
 public:
  explicit AsciiPlyBody(const TextCursor& cursor) : cursor_(cursor) {}

  double number(PlyType type) {
    cursor_.skip_to_token();
    if (is_float(type)) return cursor_.number("a number");
    return static_cast<double>(cursor_.integer<std::int64_t>("a whole number"));
  }
  std::int64_t integer(PlyType) {
    cursor_.skip_to_token();
    return cursor_.integer<std::int64_t>("a whole number");
  }
  std::size_t remaining() const { return cursor_.remaining(); }
  std::size_t least_size(PlyType) const { return 2; }
  void tell_rest(Findings& findings) {
    add_finding(findings, "lines_left_over", cursor_.count_lines(),
                "line[|s] behind the last element of the header [is|are] not read");
  }
  std::string place() const { return fmt::format("line {}", cursor_.line()); }

 private:
  TextCursor cursor_;
};

/// Values of a binary body.
template <bool is_big_endian>
class BinaryPlyBody {
 public:
  BinaryPlyBody(const std::string& path, std::string_view text, std::size_t header_size)
      : path_(path), begin_(text.data() - header_size), at_(text.data()), end_(text.data() + text.size()) {}

  double number(PlyType type) {
    if (type == PlyType::f32) return load<float>(take(4));
    if (type == PlyType::f64) return load<double>(take(8));
    return static_cast<double>(integer(type));
  }
  std::int64_t integer(PlyType type) {
    const char* const bytes = take(size_of(type));
    switch (type) {
      case PlyType::i8:
        return load<std::int8_t>(bytes);
      case PlyType::u8:
        return load<std::uint8_t>(bytes);
      case PlyType::i16:
        return load<std::int16_t>(bytes);
      case PlyType::u16:
        return load<std::uint16_t>(bytes);
      case PlyType::i32:
        return load<std::int32_t>(bytes);
      case PlyType::u32:
        return load<std::uint32_t>(bytes);
      default:
        throw IoError(path_, place() + ": expected a whole number, found a property of type float");
    }
  }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }
  std::size_t least_size(PlyType type) const { return size_of(type); }
  void tell_rest(Findings& findings) const { tell_bytes_left_over(remaining(), findings); }
  std::string place() const { return fmt::format("byte {}", at_ - begin_); }

 private:
  const char* take(std::size_t n) {
    if (remaining() < n)
      throw IoError(path_, fmt::format("byte {}: expected {} more bytes, found the end of the file",
                                       at_ - begin_, n - remaining()));
    const char* const bytes = at_;
    at_ += n;
    return bytes;
  }
  template <typename T>
  static T load(const char* bytes) {
    T value;
    if constexpr (is_big_endian) {
      char swapped[sizeof(T)];
      std::reverse_copy(bytes, bytes + sizeof(T), swapped);
      std::memcpy(&value, swapped, sizeof(T));
    } else {
      std::memcpy(&value, bytes, sizeof(T));
    }
    return value;
  }

  const std::string& path_;
  const char* begin_;
  const char* at_;
  const char* end_;
};

}  // namespace lambake
