#include "lambake/io/obj_materials.h"

#include <fmt/format.h>

#include <charconv>

#include "lambake/core/utf8.h"
#include "lambake/io/file_color.h"
#include "lambake/io/file_texture.h"
#include "lambake/io/input_file.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

bool is_number(std::string_view token) {
  float value = 0;
  const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  return error == std::errc() && stop == token.data() + token.size();
}

/// The file's name on a map_Kd line, behind its options ("-s 1 1 1", "-clamp on", …).
std::string_view skip_map_options(TextCursor& cursor, std::size_t& n_options) {
  for (;;) {
    TextCursor ahead = cursor;
    const std::string_view option = ahead.token();
    if (option.size() < 2 || option[0] != '-') return cursor.rest_of_line();
    ++n_options;
    cursor = ahead;
    const bool is_vector = option == "-o" || option == "-s" || option == "-t";
    const int n_values = is_vector ? 3 : option == "-mm" ? 2 : 1;
    for (int i = 0; i < n_values; ++i) {
      ahead = cursor;
      const std::string_view value = ahead.token();
      if (i > 0 && !is_number(value)) break;
      cursor = ahead;
    }
  }
}

}  // namespace

void ObjMaterials::read_library(const std::string& name) {
  const std::string library = path_beside(path_, name);
  std::string text;
  try {
    text = read_named_bytes(library);
  } catch (const IoError& error) {
    missing_files_.push_back(error.what());
    return;
  }
  std::size_t n_options = 0, n_transparent = 0;
  Entry* entry = nullptr;
  TextCursor cursor(library, text, '#');
  for (; cursor.skip_to_token(); cursor.next_line()) {
    const std::string_view keyword = cursor.token();
    if (keyword == "newmtl") {
      entry = &entries_[std::string(cursor.rest_of_line())];
      *entry = {};
    } else if (entry == nullptr) {
      continue;
    } else if (keyword == "Kd") {
      TextCursor ahead = cursor;
      const std::string_view kind = ahead.token();
      if (kind == "spectral" || kind == "xyz") continue;
      entry->diffuse.r = cursor.number("three numbers after Kd");
      // One number stands for all three.
      entry->diffuse.g = cursor.at_line_end() ? entry->diffuse.r : cursor.number("three numbers after Kd");
      entry->diffuse.b = cursor.at_line_end() ? entry->diffuse.r : cursor.number("three numbers after Kd");
    } else if (keyword == "map_Kd") {
      entry->texture = std::string(skip_map_options(cursor, n_options));
    } else if (keyword == "d") {
      TextCursor ahead = cursor;
      n_transparent += is_number(ahead.token()) && cursor.number("a number") < 1;
    }
  }
  add_finding(file_.findings, "texture_options", n_options, "option[|s] of map_Kd [is|are] not used");
  add_finding(file_.findings, "transparent_materials", n_transparent,
              "material[ is|s are] transparent; drawn opaque");
}

std::uint32_t ObjMaterials::use(const std::string& name) {
  const auto known = used_.find(name);
  if (known != used_.end()) return known->second;
  const auto entry = entries_.find(name);
  if (entry == entries_.end() && !name.empty()) unknown_names_.push_back(utf8_of(name));
  const std::uint32_t index = add(name, entry == entries_.end() ? Entry{} : entry->second);
  used_.emplace(name, index);
  return index;
}

void ObjMaterials::finish() {
  const auto tell = [&](const char* code, const std::string& text, const std::vector<std::string>& names) {
    if (names.empty()) return;
    const std::string others = names.size() > 1 ? fmt::format(" and {} more", names.size() - 1) : "";
    add_finding(file_.findings, code, names.size(), text + names.front() + others);
  };
  tell("missing_material_files",
       "material file[|s] could not be read, [its|their] materials are white: ", missing_files_);
  tell("unknown_materials", "material[ is|s are] not in the material files; white: ", unknown_names_);
}

std::uint32_t ObjMaterials::add(const std::string& name, const Entry& entry) {
  Material material;
  material.name = utf8_of(name);
  std::vector<LinearRgb> colors{entry.diffuse};
  decode_file_colors(colors, file_.findings);
  material.base_color = colors[0];
  if (!entry.texture.empty()) {
    const auto [known, is_new] = texture_indices_.try_emplace(entry.texture, no_texture);
    if (is_new) known->second = add_file_texture(path_, entry.texture, file_);
    material.base_color_texture = known->second;
  }
  file_.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(file_.materials.size() - 1);
}

}  // namespace lambake
