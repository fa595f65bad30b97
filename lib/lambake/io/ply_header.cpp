#include "lambake/io/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <unordered_set>
#include <utility>

#include "lambake/core/error.h"

namespace lambake {
namespace {

PlyType read_type(TextCursor& cursor) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> names{{{"char", PlyType::i8},
                                                                        {"int8", PlyType::i8},
                                                                        {"uchar", PlyType::u8},
                                                                        {"uint8", PlyType::u8},
                                                                        {"short", PlyType::i16},
                                                                        {"int16", PlyType::i16},
                                                                        {"ushort", PlyType::u16},
                                                                        {"uint16", PlyType::u16},
                                                                        {"int", PlyType::i32},
                                                                        {"int32", PlyType::i32},
                                                                        {"uint", PlyType::u32},
                                                                        {"uint32", PlyType::u32},
                                                                        {"float", PlyType::f32},
                                                                        {"float32", PlyType::f32},
                                                                        {"double", PlyType::f64},
                                                                        {"float64", PlyType::f64}}};
  const std::string_view token = cursor.token();
  for (const auto& [name, type] : names)
    if (name == token) return type;
  cursor.fail("a type of PLY (float, uchar, int, …)", token);
}

std::string read_name(TextCursor& cursor, const char* expected) {
  const std::string_view token = cursor.token();
  if (token.empty()) cursor.fail(expected, token);
  return std::string(token);
}

void read_comment(TextCursor& cursor, PlyHeader& header) {
  std::string_view text = cursor.rest_of_line();
  if (text == ply_linear_colors_comment) header.has_linear_colors = true;
  constexpr std::string_view keyword = "TextureFile";
  if (!text.starts_with(keyword)) return;
  text.remove_prefix(keyword.size());
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin != std::string_view::npos && begin > 0) header.texture_files.emplace_back(text.substr(begin));
}

/// Whether the line, of whose tokens none is left, ends with a CR that no LF follows.
bool ends_with_cr_alone(TextCursor cursor) {
  return cursor.at_line_end() && cursor.accept('\r') && !cursor.accept('\n');
}

/// Moves to the body. With lines that CR ends alone a LF is the first byte of the body.
void end_last_line(TextCursor& cursor, bool ends_with_cr) {
  if (!ends_with_cr || !cursor.accept('\r')) return cursor.next_line();
  cursor.add_lines(1);
}

/// The fewest bytes that one of the element can take.
std::size_t least_size(const PlyElement& element, PlyEncoding encoding) {
  std::size_t size = 0;
  for (const PlyProperty& p : element.properties)
    size += encoding == PlyEncoding::ascii ? 2 : size_of(p.is_list ? p.count_type : p.type);
  return size;
}

}  // namespace

void tell_bytes_left_over(std::size_t n, Findings& findings) {
  constexpr std::size_t n_of_a_line_end = 2;
  if (n > n_of_a_line_end)
    add_finding(findings, "bytes_left_over", n,
                "byte[|s] behind the last element of the header [is|are] not read");
}

PlyHeader read_ply_header(const std::string& path, TextCursor& cursor) {
  PlyHeader header;
  const std::size_t n_bytes = cursor.remaining();
  const std::string_view magic = cursor.token();
  if (magic != "ply" && magic != "PLY") cursor.fail("\"ply\"", magic);
  const bool ends_with_cr = ends_with_cr_alone(cursor);
  bool has_format = false;
  std::unordered_set<std::string> elements, properties;  // Their names; those of the last element.
  for (;;) {
    const std::string_view extra = cursor.token();
    if (!extra.empty()) cursor.fail("the end of the line", extra);
    cursor.next_line();
    if (!cursor.skip_to_token()) cursor.fail("\"end_header\"", {});
    const std::string_view keyword = cursor.token();
    if (keyword == "end_header") break;
    if (keyword == "comment" || keyword == "obj_info") {
      read_comment(cursor, header);
    } else if (keyword == "format") {
      const std::string_view encoding = cursor.token();
      if (encoding == "ascii") {
        header.encoding = PlyEncoding::ascii;
      } else if (encoding == "binary_little_endian") {
        header.encoding = PlyEncoding::little_endian;
      } else if (encoding == "binary_big_endian") {
        header.encoding = PlyEncoding::big_endian;
      } else {
        cursor.fail("\"ascii\", \"binary_little_endian\" or \"binary_big_endian\"", encoding);
      }
      if (const std::string_view version = cursor.token(); version != "1.0") cursor.fail("\"1.0\"", version);
      has_format = true;
    } else if (keyword == "element") {
      PlyElement element;
      element.name = read_name(cursor, "the element's name");
      if (!elements.insert(element.name).second)
        cursor.fail("a name that no other element has", element.name);
      properties.clear();
      element.line = cursor.line();
      element.count = cursor.integer<std::size_t>("a count");
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) cursor.fail("\"element\" before \"property\"", keyword);
      PlyProperty property;
      TextCursor ahead = cursor;
      if (ahead.token() == "list") {
        cursor = ahead;
        property.is_list = true;
        property.count_type = read_type(cursor);
        if (is_float(property.count_type)) cursor.fail("a whole-number type for the count", "float");
      }
      property.type = read_type(cursor);
      property.name = read_name(cursor, "the property's name");
      if (!properties.insert(property.name).second)
        cursor.fail("a name that no other property has", property.name);
      header.elements.back().properties.push_back(std::move(property));
    } else {
      cursor.fail("a keyword of the header or \"end_header\"", keyword);
    }
  }
  if (!has_format) cursor.fail("a \"format\" line before \"end_header\"", "end_header");
  if (const std::string_view extra = cursor.token(); !extra.empty())
    cursor.fail("the end of the line", extra);
  end_last_line(cursor, ends_with_cr);
  header.size = n_bytes - cursor.remaining();

  for (const PlyElement& element : header.elements) {
    const std::size_t least = least_size(element, header.encoding);
    // The last number of an ASCII file needs no line end.
    if (least > 0 && element.count > (cursor.remaining() + 1) / least)
      throw IoError(path, fmt::format("line {}: expected {} × \"{}\", at least {} bytes each, but the file "
                                      "has {} bytes left",
                                      element.line, element.count, element.name, least, cursor.remaining()));
  }
  return header;
}

}  // namespace lambake
