#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "lambake/core/error.h"
#include "lambake/core/utf8.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/canonical_ply.h"
#include "lambake/io/corner_attributes.h"
#include "lambake/io/file_color.h"
#include "lambake/io/file_texture.h"
#include "lambake/io/input_file.h"
#include "lambake/io/plain_ply.h"
#include "lambake/io/ply_header.h"
#include "lambake/io/text_blocks.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

/// Values of an ASCII body. Like every reader of PLY it takes line ends for blanks.
class AsciiBody {
 public:
  explicit AsciiBody(const TextCursor& cursor) : cursor_(cursor) {}

  double number(PlyType type) {
    cursor_.skip_to_token();
    if (is_float(type)) return cursor_.number("a number");
    return static_cast<double>(cursor_.integer<std::int64_t>("a whole number"));
  }
  float number_f32(PlyType type) { return static_cast<float>(number(type)); }
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

template <typename T, bool is_big_endian>
T load(const char* bytes) {
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

/// Values of a binary body.
template <bool is_big_endian>
class BinaryBody {
 public:
  BinaryBody(const std::string& path, std::string_view text, std::size_t header_size)
      : path_(path), begin_(text.data() - header_size), at_(text.data()), end_(text.data() + text.size()) {}

  double number(PlyType type) {
    if (type == PlyType::f32) return load<float, is_big_endian>(take(4));
    if (type == PlyType::f64) return load<double, is_big_endian>(take(8));
    return static_cast<double>(integer(type));
  }
  float number_f32(PlyType type) { return static_cast<float>(number(type)); }
  std::int64_t integer(PlyType type) {
    const char* const bytes = take(size_of(type));
    switch (type) {
      case PlyType::i8:
        return load<std::int8_t, is_big_endian>(bytes);
      case PlyType::u8:
        return load<std::uint8_t, is_big_endian>(bytes);
      case PlyType::i16:
        return load<std::int16_t, is_big_endian>(bytes);
      case PlyType::u16:
        return load<std::uint16_t, is_big_endian>(bytes);
      case PlyType::i32:
        return load<std::int32_t, is_big_endian>(bytes);
      case PlyType::u32:
        return load<std::uint32_t, is_big_endian>(bytes);
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

  const std::string& path_;
  const char* begin_;
  const char* at_;
  const char* end_;
};

enum class Role { none, x, y, z, nx, ny, nz, u, v, red, green, blue, alpha, indices, texcoords, texture };
constexpr std::size_t n_scalar_roles = static_cast<std::size_t>(Role::alpha) + 1;

Role role_in_vertex(const PlyProperty& p) {
  constexpr std::pair<std::string_view, Role> names[] = {{"x", Role::x},
                                                         {"y", Role::y},
                                                         {"z", Role::z},
                                                         {"nx", Role::nx},
                                                         {"ny", Role::ny},
                                                         {"nz", Role::nz},
                                                         {"u", Role::u},
                                                         {"s", Role::u},
                                                         {"texture_u", Role::u},
                                                         {"v", Role::v},
                                                         {"t", Role::v},
                                                         {"texture_v", Role::v},
                                                         {"red", Role::red},
                                                         {"green", Role::green},
                                                         {"blue", Role::blue},
                                                         {"alpha", Role::alpha},
                                                         {"diffuse_red", Role::red},
                                                         {"diffuse_green", Role::green},
                                                         {"diffuse_blue", Role::blue}};
  if (!p.is_list)
    for (const auto& [name, role] : names)
      if (name == p.name) return role;
  return Role::none;
}

Role role_in_face(const PlyProperty& p) {
  if (p.is_list) {
    if (p.name == "vertex_indices" || p.name == "vertex_index") return Role::indices;
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

/// What a colour channel is divided by to lie in [0,1].
float channel_scale(PlyType type) {
  if (is_float(type)) return 1;
  return type == PlyType::u16 ? 65535.0f : 255.0f;
}

void append_bytes(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
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

  void scan_vertices(const PlyElement& element) {
    std::vector<Role> roles;
    bool has[n_scalar_roles] = {};
    float scales[n_scalar_roles] = {};
    for (const PlyProperty& p : element.properties) {
      const Role role = role_in_vertex(p);
      roles.push_back(role);
      has[static_cast<std::size_t>(role)] = true;
      scales[static_cast<std::size_t>(role)] = 1 / channel_scale(p.type);
    }
    const auto has_all = [&](std::initializer_list<Role> all) {
      return std::all_of(all.begin(), all.end(), [&](Role r) { return has[static_cast<std::size_t>(r)]; });
    };
    if (!has_all({Role::x, Role::y, Role::z}))
      throw IoError(path_,
                    fmt::format("line {}: expected properties x, y and z of \"vertex\"", element.line));
    file_.has_normals = has_all({Role::nx, Role::ny, Role::nz});
    file_.has_texcoords = has_all({Role::u, Role::v});
    const bool has_colors = has_all({Role::red, Role::green, Role::blue});
    if (has_colors) file_.colors.reserve(element.count);
    for (const PlyProperty& p : element.properties)
      if (has_colors && is_color(role_in_vertex(p)) && is_float(p.type)) channels_ = ChannelNumbers::floats;
    const bool has_alpha = has_colors && has_all({Role::alpha});
    if (has_alpha) file_.opacities.reserve(element.count);
    const std::size_t row_size = 4 * (3 + (file_.has_normals ? 3 : 0) + (file_.has_texcoords ? 2 : 0));
    vertex_rows_.reserve(row_size * element.count);
    float values[n_scalar_roles] = {};
    const auto value = [&](Role role) { return values[static_cast<std::size_t>(role)]; };
    for (std::size_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < roles.size(); ++p) {
        if (roles[p] == Role::none) {
          skip(element.properties[p]);
        } else {
          values[static_cast<std::size_t>(roles[p])] = body_.number_f32(element.properties[p].type);
        }
      }
      append_bytes(vertex_rows_, &values[static_cast<std::size_t>(Role::x)], 12);
      if (file_.has_normals) append_bytes(vertex_rows_, &values[static_cast<std::size_t>(Role::nx)], 12);
      if (file_.has_texcoords) append_bytes(vertex_rows_, &values[static_cast<std::size_t>(Role::u)], 8);
      if (has_colors)
        file_.colors.push_back({value(Role::red) * scales[static_cast<std::size_t>(Role::red)],
                                value(Role::green) * scales[static_cast<std::size_t>(Role::green)],
                                value(Role::blue) * scales[static_cast<std::size_t>(Role::blue)]});
      if (has_alpha)
        file_.opacities.push_back(value(Role::alpha) * scales[static_cast<std::size_t>(Role::alpha)]);
    }
  }

  void scan_faces(const PlyElement& element) {
    file_.n_faces = element.count;
    std::vector<Role> roles;
    const PlyProperty* channels[3] = {};
    bool has_texcoords = false, has_texture = false, has_indices = false;
    for (const PlyProperty& p : element.properties) {
      roles.push_back(role_in_face(p));
      if (is_color(roles.back())) channels[static_cast<int>(roles.back()) - static_cast<int>(Role::red)] = &p;
      has_texcoords = has_texcoords || roles.back() == Role::texcoords;
      has_texture = has_texture || roles.back() == Role::texture;
      has_indices = has_indices || roles.back() == Role::indices;
    }
    if (!has_indices)
      throw IoError(path_,
                    fmt::format("line {}: expected a list \"vertex_indices\" of \"face\"", element.line));
    // Colours of the vertices are finer than those of the faces: where a file has both, they win.
    const PlyElement& vertex = *find("vertex");
    const auto vertex_has = [&vertex](Role role) {
      return std::any_of(vertex.properties.begin(), vertex.properties.end(),
                         [role](const auto& p) { return role_in_vertex(p) == role; });
    };
    const bool vertex_has_colors = vertex_has(Role::red) && vertex_has(Role::green) && vertex_has(Role::blue);
    const bool face_has_colors = channels[0] && channels[1] && channels[2];
    const bool has_colors = face_has_colors && !vertex_has_colors;
    for (const PlyProperty* p : channels)
      if (has_colors && is_float(p->type)) channels_ = ChannelNumbers::floats;
    if (face_has_colors && vertex_has_colors) tell_unused_face_colors(element.count, file_.findings);
    corner_attributes_.emplace(file_, has_texcoords, has_colors, has_texture);
    face_rows_.reserve(16 * element.count);  // Of triangles.

    std::vector<std::uint32_t> corners;
    std::vector<float> texcoords;
    std::size_t n_odd_texcoords = 0;
    for (std::size_t f = 0; f < element.count; ++f) {
      float color[3] = {1, 1, 1};
      double texture = 0;
      texcoords.clear();
      for (std::size_t p = 0; p < roles.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        switch (roles[p]) {
          case Role::indices:
            read_indices(property, corners);
            break;
          case Role::texcoords:
            texcoords.resize(list_length(property));
            for (float& t : texcoords) t = body_.number_f32(property.type);
            break;
          case Role::texture:
            texture = body_.number(property.type);
            break;
          case Role::red:
          case Role::green:
          case Role::blue:
            color[static_cast<int>(roles[p]) - static_cast<int>(Role::red)] =
                body_.number_f32(property.type) / channel_scale(property.type);
            break;
          default:
            skip(property);
        }
      }
      const std::uint32_t material = has_texture ? material_of_texture(texture) : 0;
      if (has_texture) file_.face_materials.push_back(material);
      if (has_colors || has_texcoords || has_texture) {
        const LinearRgb c{color[0], color[1], color[2]};
        const bool is_mapped = texcoords.size() == 2 * corners.size();
        n_odd_texcoords += has_texcoords && !is_mapped;
        for (std::size_t i = 0; i < corners.size(); ++i) {
          const glm::vec2 t = is_mapped ? glm::vec2(texcoords[2 * i], texcoords[2 * i + 1]) : glm::vec2(0);
          corners[i] = corner_attributes_->vertex_for(corners[i], t, c, material);
        }
      }
      append_face(corners);
    }
    add_finding(file_.findings, "odd_texcoords", n_odd_texcoords,
                "face[ has|s have] no texture coordinate for each corner; (0,0) instead");
  }

  std::uint32_t material_of_texture(double number) const {
    const auto n = static_cast<std::uint32_t>(header_.texture_files.size());
    return number >= 0 && number < n ? static_cast<std::uint32_t>(number) : n;
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
};

}  // namespace

CanonicalFile scan_ply(const std::string& path) {
  InputFile input(path);
  TextBlocks blocks(input);
  TextCursor cursor(path, blocks, 0);
  const PlyHeader header = read_ply_header(path, cursor);
  CanonicalFile file;
  std::string bytes;  // Of a binary file: all of them.
  if (header.encoding == PlyEncoding::ascii) {
    file.format = "PLY ascii";
    PlyScan(path, header, AsciiBody(cursor), bytes, file).run();
    return file;
  }
  input.rewind();
  bytes = input.take();
  const std::string_view body = std::string_view(bytes).substr(header.size);
  if (header.encoding == PlyEncoding::big_endian) {
    file.format = "PLY binary BE";
    PlyScan(path, header, BinaryBody<true>(path, body, header.size), bytes, file).run();
  } else {
    file.format = "PLY binary LE";
    if (!take_plain_ply(header, bytes, file))
      PlyScan(path, header, BinaryBody<false>(path, body, header.size), bytes, file).run();
  }
  return file;
}

}  // namespace lambake
