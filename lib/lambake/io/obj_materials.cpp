#include "lambake/io/obj_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "lambake/core/utf8.h"
#include "lambake/io/file_color.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/image_file.h"
#include "lambake/io/input_file.h"
#include "lambake/io/text_encoding.h"

namespace lambake {
namespace {

std::optional<float> number_of(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  float value = 0;
  const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || stop != token.data() + token.size()) return std::nullopt;
  return value;
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
      if (i > 0 && !number_of(value)) break;
      cursor = ahead;
    }
  }
}

bool is_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

std::vector<std::string> split_at_blanks(std::string_view names) {
  std::vector<std::string> parts;
  constexpr const char* blanks = " \t";
  for (std::size_t end = 0, begin; (begin = names.find_first_not_of(blanks, end)) != names.npos;) {
    end = std::min(names.find_first_of(blanks, begin), names.size());
    parts.emplace_back(names.substr(begin, end - begin));
  }
  return parts;
}

/// What a line lets through of the light behind the surface. d is the opacity, Tr the opposite; but some
/// programs write Tr 1 where they mean opaque, others Tr 0. Tf is a colour: what is no white is a filter.
bool is_transparency(TextCursor& cursor, std::string_view keyword) {
  if (keyword == "map_d") return true;
  std::string_view token = cursor.token();
  if (token == "-halo") token = cursor.token();
  const std::optional<float> value = number_of(token);
  if (keyword == "d") return value && *value < 1;
  if (keyword == "tr") return value && *value > 0 && *value < 1;
  bool is_white = value == 1;
  while (!cursor.at_line_end()) is_white = number_of(cursor.token()) == 1 && is_white;
  return keyword == "tf" && !is_white;
}

}  // namespace

void ObjMaterials::read_libraries(std::string_view names) {
  const auto exists = [this](const std::string& name) { return is_file(path_beside(path_, name)); };
  const std::string whole(names);
  const std::vector<std::string> parts = split_at_blanks(names);
  if (exists(whole) || std::none_of(parts.begin(), parts.end(), exists)) return read_library(whole);
  for (const std::string& part : parts) read_library(part);
}

void ObjMaterials::read_library(const std::string& name) {
  if (!libraries_.insert(name).second) return;
  const std::string library = path_beside(path_, name);
  file_.referred_files.push_back(library);
  std::string bytes;
  std::string_view text;
  try {
    bytes = read_named_bytes(library);
    text = as_utf8(library, bytes);
  } catch (const IoError& error) {
    missing_files_.push_back(error.what());
    return;
  }
  Entry* entry = nullptr;
  TextCursor cursor(library, text, '#');
  for (; cursor.skip_to_token(); cursor.next_line()) {
    const std::string keyword = in_lower_case(std::string(cursor.token()));
    if (keyword == "newmtl") {
      entry = &entries_[std::string(cursor.rest_of_line())];
      *entry = {};
    } else if (entry != nullptr) {
      read_line(cursor, keyword, *entry);
    }
  }
}

void ObjMaterials::read_line(TextCursor& cursor, std::string_view keyword, Entry& entry) {
  if (keyword == "kd") {
    entry.diffuse = read_color(cursor, "three numbers after Kd").value_or(LinearRgb{1, 1, 1});
  } else if (keyword == "ke") {
    entry.emission = read_color(cursor, "three numbers after Ke").value_or(LinearRgb{0, 0, 0});
  } else if (keyword == "map_kd") {
    entry.texture = std::string(skip_map_options(cursor, n_options_));
  } else if (keyword == "map_ke") {
    entry.emission_texture = std::string(skip_map_options(cursor, n_options_));
  } else if (keyword == "d" || keyword == "tr" || keyword == "tf" || keyword == "map_d") {
    entry.is_transparent = is_transparency(cursor, keyword) || entry.is_transparent;
  }
}

/// Three numbers, or one that stands for all; none, and counted, if they are no RGB.
std::optional<LinearRgb> ObjMaterials::read_color(TextCursor& cursor, const char* expected) {
  TextCursor ahead = cursor;
  const std::string_view kind = ahead.token();
  if (kind == "spectral" || kind == "xyz") {
    ++n_unread_colors_;
    return std::nullopt;
  }
  LinearRgb color;
  color.r = cursor.number(expected);
  color.g = cursor.at_line_end() ? color.r : cursor.number(expected);
  color.b = cursor.at_line_end() ? color.r : cursor.number(expected);
  return color;
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
  const auto n_transparent = std::count_if(entries_.begin(), entries_.end(),
                                           [](const auto& entry) { return entry.second.is_transparent; });
  Findings& findings = file_.findings;
  add_finding(findings, "texture_options", n_options_, "option[|s] of map_Kd or map_Ke [is|are] not used");
  add_finding(findings, "transparent_materials", static_cast<std::size_t>(n_transparent),
              "material[ is|s are] transparent; drawn opaque");
  add_finding(findings, "unread_material_colors", n_unread_colors_,
              "colour[ of a material is|s of materials are] given as a spectrum or as XYZ; not read");
  add_finding(findings, "odd_emissions", n_odd_emissions_,
              "material[ has|s have] an emission below 0, not finite or too large; 0 instead");
}

std::uint32_t ObjMaterials::add(const std::string& name, const Entry& entry) {
  Material material;
  material.name = utf8_of(name);
  std::vector<LinearRgb> colors{entry.diffuse};
  decode_file_colors(colors, file_.findings);
  material.base_color = colors[0];
  if (!entry.texture.empty()) material.base_color_texture = textures_.use(entry.texture);
  material.emission = emission_of(entry);
  if (has_emission(material) && !entry.emission_texture.empty()) {
    material.emission_texture = textures_.use(entry.emission_texture, "no emission");
    if (material.emission_texture != no_texture &&
        is_black(file_.images[file_.textures[material.emission_texture].image]))
      material.emission_texture = no_texture;
    if (material.emission_texture == no_texture) material.emission = {0, 0, 0};
  }
  file_.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(file_.materials.size() - 1);
}

/// By the curve of sRGB like all colours of the file, above 1 as well.
LinearRgb ObjMaterials::emission_of(const Entry& entry) {
  const LinearRgb encoded =
      entry.emission.value_or(entry.emission_texture.empty() ? LinearRgb{0, 0, 0} : LinearRgb{1, 1, 1});
  LinearRgb emission{srgb_decode(encoded.r), srgb_decode(encoded.g), srgb_decode(encoded.b)};
  const bool is_sound = is_finite(emission) && std::min({encoded.r, encoded.g, encoded.b}) >= 0;
  n_odd_emissions_ += !is_sound;
  return is_sound ? emission : LinearRgb{0, 0, 0};
}

}  // namespace lambake
