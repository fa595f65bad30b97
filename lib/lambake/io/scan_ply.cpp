#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <optional>
#include <span>

#include "lambake/core/error.h"
#include "lambake/core/utf8.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/canonical_ply.h"
#include "lambake/io/corner_attributes.h"
#include "lambake/io/file_color.h"
#include "lambake/io/file_extension.h"
#include "lambake/io/file_texture.h"
#include "lambake/io/input_file.h"
#include "lambake/io/plain_ply.h"
#include "lambake/io/ply_body.h"
#include "lambake/io/ply_header.h"
#include "lambake/io/text_blocks.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

enum class Role { none, x, y, z, nx, ny, nz, u, v, red, green, blue, alpha, indices, texcoords, texture };

/// A value for each role.
template <typename T>
struct ByRole {
  std::array<T, static_cast<std::size_t>(Role::texture) + 1> values{};

  T& operator[](Role role) { return values[static_cast<std::size_t>(role)]; }
  const T& operator[](Role role) const { return values[static_cast<std::size_t>(role)]; }
};

Role role_in_vertex(const PlyProperty& p) {
  // By role, from x on.
  constexpr std::string_view names[][3] = {{"x"},
                                           {"y"},
                                           {"z"},
                                           {"nx"},
                                           {"ny"},
                                           {"nz"},
                                           {"u", "s", "texture_u"},
                                           {"v", "t", "texture_v"},
                                           {"red", "diffuse_red", "r"},
                                           {"green", "diffuse_green", "g"},
                                           {"blue", "diffuse_blue", "b"},
                                           {"alpha", "diffuse_alpha", "a"}};
  const std::string name = in_lower_case(p.name);
  if (!p.is_list)
    for (std::size_t i = 0; i < std::size(names); ++i)
      if (std::find(std::begin(names[i]), std::end(names[i]), name) != std::end(names[i]))
        return static_cast<Role>(static_cast<std::size_t>(Role::x) + i);
  return Role::none;
}

Role role_in_face(const PlyProperty& p) {
  if (p.is_list) {
    if (is_index_list(p)) return Role::indices;
    return p.name == "texcoord" ? Role::texcoords : Role::none;
  }
  if (p.name == "red") return Role::red;
  if (p.name == "green") return Role::green;
  if (p.name == "blue") return Role::blue;
  return p.name == "texnumber" ? Role::texture : Role::none;
}

bool is_color(Role role) {
  return role == Role::red || role == Role::green || role == Role::blue;
}

/// What the properties of an element stand for.
struct Roles {
  Roles(const PlyElement& element, Role (*role_of)(const PlyProperty&)) {
    for (const PlyProperty& p : element.properties) {
      of_property.push_back(role_of(p));
      property[of_property.back()] = &p;
      has_float_colors = has_float_colors || (is_color(of_property.back()) && is_float(p.type));
    }
  }
  bool has(std::initializer_list<Role> roles) const {
    return std::all_of(roles.begin(), roles.end(), [this](Role role) { return property[role] != nullptr; });
  }
  bool has_colors() const { return has({Role::red, Role::green, Role::blue}); }

  std::vector<Role> of_property;
  ByRole<const PlyProperty*> property;  ///< The last one of each role, or none.
  bool has_float_colors = false;
};

/// What a colour channel is divided by to lie in [0,1].
float channel_scale(PlyType type) {
  if (is_float(type)) return 1;
  return type == PlyType::u16 ? 65535.0f : 255.0f;
}

/// Turns the body into the canonical file.
template <typename Body>
class PlyScan {
 public:
  /// @param bytes  what the body is in; is emptied in the end.
  PlyScan(const std::string& path, const PlyHeader& header, Body body, std::string& bytes,
          CanonicalFile& file)
      : path_(path), header_(header), body_(body), bytes_(bytes), file_(file), kept_(file) {}

  void run() {
    const PlyElement* vertex = find("vertex");
    if (vertex == nullptr) throw IoError(path_, "header: expected an element \"vertex\", found none");
    if (vertex->count > std::numeric_limits<std::int32_t>::max())
      throw IoError(path_, fmt::format("line {}: expected fewer than 2^31 vertices, found {}", vertex->line,
                                       vertex->count));
    const PlyElement *face = find("face"), *strips = find("tristrips");
    if (face != nullptr && strips != nullptr && face->count > 0 && strips->count > 0)
      throw IoError(path_, fmt::format("line {}: expected either \"face\" or \"tristrips\", found both",
                                       std::max(face->line, strips->line)));
    if (face == nullptr || face->count == 0) face = strips;
    if (face == nullptr || face->count == 0)
      throw IoError(path_, "header: expected faces, found none (a point cloud has nothing to light)");
    file_.n_vertices = vertex->count;
    for (const PlyElement& element : header_.elements) {
      if (&element == vertex) {
        scan_vertices(element);
      } else if (&element == face && face->name == "face") {
        scan_faces(element);
      } else if (&element == face) {
        scan_strips(element);
      } else {
        skip(element);
      }
    }
    finish();
  }

 private:
  const PlyElement* find(std::string_view name) const {
    for (const PlyElement& element : header_.elements)
      if (element.name == name) return &element;
    return nullptr;
  }

  std::size_t list_length(const PlyProperty& p) {
    const std::int64_t n = body_.integer(p.count_type);
    if (n < 0 || static_cast<std::size_t>(n) > (body_.remaining() + 1) / body_.least_size(p.type))
      throw IoError(path_, fmt::format("{}: expected the length of \"{}\", found {} with {} bytes left",
                                       body_.place(), p.name, n, body_.remaining()));
    return static_cast<std::size_t>(n);
  }
  void skip(const PlyProperty& p) {
    const std::size_t n = p.is_list ? list_length(p) : 1;
    for (std::size_t i = 0; i < n; ++i) body_.number(p.type);
  }
  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::size_t i = 0; i < element.count; ++i)
      for (const PlyProperty& p : element.properties) skip(p);
  }

  float number_f32(PlyType type) { return static_cast<float>(body_.number(type)); }

  void scan_vertices(const PlyElement& element) {
    const Roles roles(element, role_in_vertex);
    if (!roles.has({Role::x, Role::y, Role::z}))
      throw IoError(path_,
                    fmt::format("line {}: expected properties x, y and z of \"vertex\"", element.line));
    file_.has_normals = roles.has({Role::nx, Role::ny, Role::nz});
    file_.has_texcoords = roles.has({Role::u, Role::v});
    const bool has_colors = roles.has_colors(), has_alpha = has_colors && roles.has({Role::alpha});
    if (has_colors) use_colors(roles);
    if (has_colors) file_.colors.reserve(element.count);
    if (has_alpha) file_.opacities.reserve(element.count);
    vertex_rows_.reserve(element.count *
                         row_size(canonical_vertices(1, file_.has_normals, file_.has_texcoords)));
    ByRole<float> values, scales;
    for (const Role role : {Role::red, Role::green, Role::blue, Role::alpha})
      if (roles.has({role})) scales[role] = 1 / channel_scale(roles.property[role]->type);
    const auto channel = [&](Role role) { return values[role] * scales[role]; };
    for (std::size_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (roles.of_property[p] == Role::none) {
          skip(element.properties[p]);
        } else {
          values[roles.of_property[p]] = number_f32(element.properties[p].type);
        }
      }
      append_values(vertex_rows_, &values[Role::x], 3);
      if (file_.has_normals) append_values(vertex_rows_, &values[Role::nx], 3);
      if (file_.has_texcoords) append_values(vertex_rows_, &values[Role::u], 2);
      if (has_colors) file_.colors.push_back({channel(Role::red), channel(Role::green), channel(Role::blue)});
      if (has_alpha) file_.opacities.push_back(channel(Role::alpha));
    }
  }

  void use_colors(const Roles& roles) {
    channels_ = roles.has_float_colors ? ChannelNumbers::floats : ChannelNumbers::whole;
  }

  struct Face {
    std::vector<std::uint32_t> corners;
    std::vector<float> texcoords;  ///< Two of each corner, if the file is right.
    ByRole<float> channels;        ///< Of the colour.
    double texture = 0;
  };

  void scan_faces(const PlyElement& element) {
    file_.n_faces = element.count;
    const Roles roles(element, role_in_face);
    if (!roles.has({Role::indices}))
      throw IoError(path_,
                    fmt::format("line {}: expected a list \"vertex_indices\" of \"face\"", element.line));
    // Colours of the vertices are finer than those of the faces: where a file has both, they win.
    const bool vertex_has_colors = Roles(*find("vertex"), role_in_vertex).has_colors();
    const bool has_colors = roles.has_colors() && !vertex_has_colors;
    if (has_colors) use_colors(roles);
    if (roles.has_colors() && vertex_has_colors) tell_unused_face_colors(element.count, file_.findings);
    const bool has_texcoords = roles.has({Role::texcoords}), has_texture = roles.has({Role::texture});
    corner_attributes_.emplace(file_, has_texcoords, has_colors, has_texture);
    face_rows_.reserve(16 * element.count);  // Of triangles.

    Face face;
    std::size_t n_odd_texcoords = 0;
    for (std::size_t f = 0; f < element.count; ++f) {
      read_face(element, roles, face);
      const std::uint32_t material = has_texture ? material_of_texture(face.texture) : 0;
      if (has_texture) file_.face_materials.push_back(material);
      if (has_colors || has_texcoords || has_texture)
        n_odd_texcoords += !split_corners(face, material) && has_texcoords;
      append_face(face.corners);
    }
    add_finding(file_.findings, "unknown_textures", n_unknown_textures_,
                "face[ names a texture|s name textures] that the file does not list; white instead");
    add_finding(file_.findings, "odd_texcoords", n_odd_texcoords,
                "face[ has|s have] no texture coordinate for each corner; (0,0) instead");
  }

  void read_face(const PlyElement& element, const Roles& roles, Face& face) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      switch (roles.of_property[p]) {
        case Role::indices:
          read_indices(property, face.corners);
          break;
        case Role::texcoords:
          face.texcoords.resize(list_length(property));
          for (float& t : face.texcoords) t = number_f32(property.type);
          break;
        case Role::texture:
          face.texture = body_.number(property.type);
          break;
        case Role::none:
          skip(property);
          break;
        default:
          face.channels[roles.of_property[p]] = number_f32(property.type) / channel_scale(property.type);
      }
    }
  }

  /// Gives the corners vertices that have the attributes of the face. @returns whether it has a texture
  /// coordinate for each.
  bool split_corners(Face& face, std::uint32_t material) {
    const LinearRgb color{face.channels[Role::red], face.channels[Role::green], face.channels[Role::blue]};
    const bool is_mapped = face.texcoords.size() == 2 * face.corners.size();
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const glm::vec2 t =
          is_mapped ? glm::vec2(face.texcoords[2 * i], face.texcoords[2 * i + 1]) : glm::vec2(0);
      face.corners[i] = corner_attributes_->vertex_for(face.corners[i], t, color, material);
    }
    return is_mapped;
  }

  std::uint32_t material_of_texture(double number) {
    const auto n = static_cast<std::uint32_t>(header_.texture_files.size());
    if (number >= 0 && number < n) return static_cast<std::uint32_t>(number);
    n_unknown_textures_ += n > 0 && number >= n;
    return n;
  }

  void read_indices(const PlyProperty& p, std::vector<std::uint32_t>& corners) {
    corners.resize(list_length(p));
    for (std::uint32_t& corner : corners) corner = check_index(body_.integer(p.type));
  }
  std::uint32_t check_index(std::int64_t index) {
    if (index < 0 || index >= static_cast<std::int64_t>(file_.n_vertices))
      throw IoError(path_, fmt::format("{}: expected a vertex index below {}, found {}", body_.place(),
                                       file_.n_vertices, index));
    return static_cast<std::uint32_t>(index);
  }

  void append_face(std::span<const std::uint32_t> corners) {
    if (!kept_.keep(corners.size())) return;
    append_face_row(face_rows_, corners);
  }

  /// Triangle strips: lists of indices in which a negative one ends a strip; every second triangle of a strip
  /// winds the other way.
  void scan_strips(const PlyElement& element) {
    const PlyProperty* indices = nullptr;
    for (const PlyProperty& p : element.properties)
      if (role_in_face(p) == Role::indices) indices = &p;
    if (indices == nullptr)
      throw IoError(
          path_, fmt::format("line {}: expected a list \"vertex_indices\" of \"tristrips\"", element.line));
    for (std::size_t s = 0; s < element.count; ++s)
      for (const PlyProperty& p : element.properties) {
        if (&p != indices) {
          skip(p);
          continue;
        }
        std::uint32_t last[2] = {};
        std::size_t n_in_strip = 0;
        const std::size_t n = list_length(p);
        for (std::size_t i = 0; i < n; ++i) {
          const std::int64_t index = body_.integer(p.type);
          if (index < 0) {
            n_in_strip = 0;
            continue;
          }
          const std::uint32_t v = check_index(index);
          if (n_in_strip >= 2) {
            const bool is_odd = n_in_strip % 2 == 1;
            const std::uint32_t corners[3] = {last[is_odd ? 1 : 0], last[is_odd ? 0 : 1], v};
            append_face(corners);
            ++file_.n_faces;
          }
          last[0] = last[1];
          last[1] = v;
          ++n_in_strip;
        }
      }
  }

  void finish() {
    kept_.finish(path_);
    body_.tell_rest(file_.findings);
    if (!header_.has_linear_colors)
      decode_file_opacities(file_.opacities, decode_file_colors(file_.colors, file_.findings, channels_));
    if (corner_attributes_) corner_attributes_->finish();
    FileTextures textures(path_, file_);
    for (const std::string& name : header_.texture_files) {
      Material material;
      material.name = utf8_of(name);
      material.base_color_texture = textures.use(name);
      file_.materials.push_back(material);
    }
    if (!file_.materials.empty()) file_.materials.emplace_back();  // For faces without one.

    std::string().swap(bytes_);  // All of it has been read; only this gives the memory back.
    write_canonical_ply(std::move(vertex_rows_), std::move(face_rows_), kept_.n_kept(), file_);
  }

  const std::string& path_;
  const PlyHeader& header_;
  Body body_;
  std::string& bytes_;
  CanonicalFile& file_;
  std::optional<CornerAttributes> corner_attributes_;
  KeptFaces kept_;
  ChannelNumbers channels_ = ChannelNumbers::whole;  // Of the colours that are used.
  std::string vertex_rows_, face_rows_;
  std::size_t n_unknown_textures_ = 0;
};

}  // namespace

CanonicalFile scan_ply(const std::string& path) {
  InputFile input(path);
  TextBlocks blocks(input);
  TextCursor cursor(path, blocks, 0);
  const PlyHeader header = read_ply_header(path, cursor, input.size());
  CanonicalFile file;
  std::string bytes;  // Of a binary file: all of them.
  if (header.encoding == PlyEncoding::ascii) {
    file.format = "PLY ascii";
    PlyScan(path, header, AsciiPlyBody(cursor), bytes, file).run();
    return file;
  }
  input.rewind();
  bytes = input.take();
  const std::string_view body = std::string_view(bytes).substr(header.size);
  if (header.encoding == PlyEncoding::big_endian) {
    file.format = "PLY binary BE";
    PlyScan(path, header, BinaryPlyBody<true>(path, body, header.size), bytes, file).run();
  } else {
    file.format = "PLY binary LE";
    if (!take_plain_ply(header, bytes, file))
      PlyScan(path, header, BinaryPlyBody<false>(path, body, header.size), bytes, file).run();
  }
  return file;
}

}  // namespace lambake
