#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "lambake/core/finding.h"
#include "lambake/io/text_cursor.h"

namespace lambake {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

inline std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<int>(type)];
}
inline bool is_float(PlyType type) {
  return type == PlyType::f32 || type == PlyType::f64;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  bool is_list = false;
  PlyType count_type = PlyType::u8;  ///< Of a list.

  friend bool operator==(const PlyProperty&, const PlyProperty&) = default;
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties{};
  std::size_t line = 0;  ///< Where it is declared.
};

/// Adds numbers of one type.
void add_properties(PlyElement& element, PlyType type, std::initializer_list<std::string_view> names);

/// Bytes of each one of an element in a binary file; of a list only those of its count.
std::size_t row_size(const PlyElement& element);

/// Whether the property is the list of a face's vertices.
bool is_index_list(const PlyProperty& property);

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> texture_files;  ///< Named by "comment TextureFile".
  bool has_linear_colors = false;          ///< "comment colours are linear", as lambake writes it.
  std::size_t size = 0;                    ///< Bytes up to the first of the body.
};

/// What lambake writes into a PLY whose float colours are linear.
inline constexpr std::string_view ply_linear_colors_comment = "colours are linear";

/// Tells of `n` bytes of a binary file that nothing in its header stands for; a line end is none.
void tell_bytes_left_over(std::size_t n, Findings& findings);

/// Reads the header and checks that the body can hold what it promises.
/// @param cursor  at the beginning of the file; left at the beginning of the body.
/// @param file_size  in bytes. @throws IoError.
PlyHeader read_ply_header(const std::string& path, TextCursor& cursor, std::size_t file_size);

/// The header of a little-endian file.
std::string ply_header_text(const std::vector<std::string>& comments,
                            const std::vector<PlyElement>& elements);

}  // namespace lambake
