#include "lambake/io/ply_header.h"

#include <fmt/format.h>

#include <iterator>
#include <unordered_set>

#include "lambake/core/error.h"

namespace lambake {
namespace {

/// By type: the one that is written, and another.
constexpr std::string_view type_names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                              {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                              {"float", "float32"}, {"double", "float64"}};

std::string_view name_of(PlyType type) {
  return type_names[static_cast<std::size_t>(type)][0];
}

PlyType read_type(TextCursor& cursor) {
  const std::string_view token = cursor.token();
  for (std::size_t i = 0; i < std::size(type_names); ++i)
    if (token == type_names[i][0] || token == type_names[i][1]) return static_cast<PlyType>(i);
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

void read_format(TextCursor& cursor, PlyHeader& header) {
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
}

PlyElement read_element(TextCursor& cursor, std::unordered_set<std::string>& names) {
  PlyElement element;
  element.name = read_name(cursor, "the element's name");
  if (!names.insert(element.name).second) cursor.fail("a name that no other element has", element.name);
  element.line = cursor.line();
  element.count = cursor.integer<std::size_t>("a count");
  return element;
}

PlyProperty read_property(TextCursor& cursor, std::unordered_set<std::string>& names) {
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
  if (!names.insert(property.name).second) cursor.fail("a name that no other property has", property.name);
  return property;
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

/// @throws IoError if the `n_bytes` of the body cannot hold what the header promises.
void check_counts(const std::string& path, const PlyHeader& header, std::size_t n_bytes) {
  for (const PlyElement& element : header.elements) {
    const std::size_t least =
        header.encoding == PlyEncoding::ascii ? 2 * element.properties.size() : row_size(element);
    // The last number of an ASCII file needs no line end.
    if (least > 0 && element.count > (n_bytes + 1) / least)
      throw IoError(path, fmt::format("line {}: expected {} × \"{}\", at least {} bytes each, but the file "
                                      "has {} bytes left",
                                      element.line, element.count, element.name, least, n_bytes));
  }
}

}  // namespace

void add_properties(PlyElement& element, PlyType type, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) element.properties.push_back({std::string(name), type});
}

std::size_t row_size(const PlyElement& element) {
  std::size_t size = 0;
  for (const PlyProperty& p : element.properties) size += size_of(p.is_list ? p.count_type : p.type);
  return size;
}

bool is_index_list(const PlyProperty& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

void tell_bytes_left_over(std::size_t n, Findings& findings) {
  constexpr std::size_t n_of_a_line_end = 2;
  if (n > n_of_a_line_end)
    add_finding(findings, "bytes_left_over", n,
                "byte[|s] behind the last element of the header [is|are] not read");
}

PlyHeader read_ply_header(const std::string& path, TextCursor& cursor, std::size_t file_size) {
  PlyHeader header;
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
      read_format(cursor, header);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(cursor, elements));
      properties.clear();
    } else if (keyword == "property") {
      if (header.elements.empty()) cursor.fail("\"element\" before \"property\"", keyword);
      header.elements.back().properties.push_back(read_property(cursor, properties));
    } else {
      cursor.fail("a keyword of the header or \"end_header\"", keyword);
    }
  }
  if (!has_format) cursor.fail("a \"format\" line before \"end_header\"", "end_header");
  if (const std::string_view extra = cursor.token(); !extra.empty())
    cursor.fail("the end of the line", extra);
  end_last_line(cursor, ends_with_cr);
  header.size = file_size - cursor.remaining();
  check_counts(path, header, cursor.remaining());
  return header;
}

std::string ply_header_text(const std::vector<std::string>& comments,
                            const std::vector<PlyElement>& elements) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : comments) text += fmt::format("comment {}\n", comment);
  for (const PlyElement& element : elements) {
    text += fmt::format("element {} {}\n", element.name, element.count);
    for (const PlyProperty& p : element.properties) {
      const std::string list = p.is_list ? fmt::format("list {} ", name_of(p.count_type)) : "";
      text += fmt::format("property {}{} {}\n", list, name_of(p.type), p.name);
    }
  }
  return text + "end_header\n";
}

}  // namespace lambake
