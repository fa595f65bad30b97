#include <fmt/format.h>

#include <cstring>
#include <limits>

#include "lambake/core/error.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/corner_attributes.h"
#include "lambake/io/file_color.h"
#include "lambake/io/input_file.h"

namespace lambake {
namespace {

// The numbers of OpenMesh/Core/IO/OMFormat.hh.
enum class Entity { vertex = 0, mesh = 1, face = 2, edge = 4, halfedge = 6, sentinel = 7 };
enum class Kind { position = 0, normal = 1, texcoord = 2, status = 3, color = 4, custom = 6, topology = 7 };
constexpr std::uint8_t version_2_0 = 2 << 5, version_2_1 = version_2_0 + 1, version_2_2 = version_2_0 + 2;

struct Chunk {
  bool is_named = false;
  Entity entity = Entity::sentinel;
  Kind kind = Kind::position;
  int bits = 0;  ///< Of floats: 0 is 4 bytes, 1 is 8. Of whole numbers: 2^bits bytes.
};

Chunk decode_chunk(std::uint16_t word) {
  return {(word >> 1 & 1) != 0, static_cast<Entity>(word >> 2 & 7), static_cast<Kind>(word >> 5 & 15),
          word >> 14 & 3};
}

std::uint16_t encode_chunk(Entity entity, Kind kind, int dimensions, bool is_float, int bits) {
  return static_cast<std::uint16_t>(static_cast<int>(entity) << 2 | static_cast<int>(kind) << 5 | 1 << 9 |
                                    int{is_float} << 10 | (dimensions - 1) << 11 | bits << 14);
}

/// Bytes of the file, taken from the front.
class ByteCursor {
 public:
  ByteCursor(const std::string& path, std::string_view bytes) : path_(path), bytes_(bytes) {}

  std::string_view take(std::size_t n, std::size_t size, const char* what) {
    if (size > 0 && n > (bytes_.size() - at_) / size)
      fail(fmt::format("{} × {} bytes of {}", n, size, what), fmt::format("{} bytes", bytes_.size() - at_));
    const std::string_view taken = bytes_.substr(at_, n * size);
    at_ += n * size;
    return taken;
  }
  template <typename T>
  T value(const char* what) {
    T result;
    std::memcpy(&result, take(1, sizeof(T), what).data(), sizeof(T));
    return result;
  }
  /// A signed whole number of 2^bits bytes.
  std::int64_t integer(int bits, const char* what) {
    return bits == 0   ? value<std::int8_t>(what)
           : bits == 1 ? value<std::int16_t>(what)
           : bits == 2 ? value<std::int32_t>(what)
                       : value<std::int64_t>(what);
  }
  /// The same, unsigned.
  std::uint64_t count(int bits, const char* what) {
    return bits == 0   ? value<std::uint8_t>(what)
           : bits == 1 ? value<std::uint16_t>(what)
           : bits == 2 ? value<std::uint32_t>(what)
                       : value<std::uint64_t>(what);
  }
  bool is_at_end() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw IoError(path_, fmt::format("byte {}: expected {}, found {}", at_, expected, found));
  }

 private:
  const std::string& path_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Vectors of 4- or 8-byte floats as 4-byte floats.
template <int n>
std::vector<glm::vec<n, float>> to_vectors(std::string_view bytes, bool is_double) {
  std::vector<glm::vec<n, float>> vectors(bytes.size() / (n * (is_double ? 8 : 4)));
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (is_double) {
      glm::vec<n, double> v;
      std::memcpy(&v, bytes.data() + i * sizeof v, sizeof v);
      vectors[i] = glm::vec<n, float>(v);
    } else {
      std::memcpy(&vectors[i], bytes.data() + i * sizeof vectors[i], sizeof vectors[i]);
    }
  }
  return vectors;
}

std::vector<LinearRgb> to_colors(std::string_view bytes) {
  std::vector<LinearRgb> colors;
  colors.reserve(bytes.size() / 3);
  const auto channel = [bytes](std::size_t i) { return static_cast<std::uint8_t>(bytes[i]) / 255.0f; };
  for (std::size_t i = 0; i + 2 < bytes.size(); i += 3)
    colors.push_back({channel(i), channel(i + 1), channel(i + 2)});
  return colors;
}

/// Turns a file of any version into one of version 1, whose faces are lists of vertices: OpenMesh's reader
/// follows the half-edges of later versions without a check.
class OmScan {
 public:
  OmScan(const std::string& path, std::string_view bytes, CanonicalFile& file)
      : path_(path), cursor_(path, bytes), file_(file) {}

  void run() {
    scan_header();
    for (;;) {
      const Chunk chunk = decode_chunk(cursor_.value<std::uint16_t>("a chunk's header"));
      if (chunk.entity == Entity::sentinel) break;
      scan_chunk(chunk);
      // Version 1 has no sentinel: its last chunk ends the file.
      if (version_ < version_2_0 && has_faces_ && cursor_.is_at_end()) break;
    }
    finish();
  }

 private:
  struct Halfedge {
    std::int64_t next, to, face;
  };

  void scan_header() {
    const std::string_view magic = cursor_.take(1, 4, "a header");
    mesh_ = magic[2];
    version_ = static_cast<std::uint8_t>(magic[3]);
    if (!magic.starts_with("OM") || (mesh_ != 'T' && mesh_ != 'Q' && mesh_ != 'P'))
      throw IoError(path_, "byte 0: expected \"OMT\", \"OMQ\" or \"OMP\", found something else");
    if (version_ > version_2_2)
      throw IoError(path_, fmt::format("byte 3: expected version 2.2 or earlier, found {}.{}", version_ >> 5,
                                       version_ & 31));
    file_.n_vertices = cursor_.value<std::uint32_t>("a header");
    file_.n_faces = cursor_.value<std::uint32_t>("a header");
    n_edges_ = cursor_.value<std::uint32_t>("a header");
    if (file_.n_faces == 0) throw IoError(path_, "byte 8: expected faces, found 0");
    if (file_.n_vertices > std::numeric_limits<std::int32_t>::max())
      throw IoError(path_,
                    fmt::format("byte 4: expected fewer than 2^31 vertices, found {}", file_.n_vertices));
  }

  void scan_chunk(const Chunk& chunk) {
    if (chunk.is_named) take_name();
    const std::size_t n_vertices = file_.n_vertices, n_faces = file_.n_faces, n_halfedges = 2 * n_edges_;
    const bool is_double = chunk.bits == 1;
    const std::size_t float_size = is_double ? 8 : 4;
    if (chunk.kind == Kind::custom) {
      if (version_ > version_2_1) take_name();  // The name of its type.
      cursor_.take(cursor_.value<std::uint32_t>("a block's size"), 1, "a custom property");
      ++n_custom_;
      return;
    }
    const std::size_t n = chunk.entity == Entity::vertex     ? n_vertices
                          : chunk.entity == Entity::face     ? n_faces
                          : chunk.entity == Entity::halfedge ? n_halfedges
                                                             : n_edges_;
    if (chunk.kind == Kind::status && chunk.entity != Entity::mesh) {
      cursor_.take(n, 4, "status");
    } else if (chunk.entity == Entity::vertex && chunk.kind == Kind::position) {
      positions_ = to_vectors<3>(cursor_.take(n, 3 * float_size, "positions"), is_double);
    } else if (chunk.entity == Entity::vertex && chunk.kind == Kind::normal) {
      normals_ = to_vectors<3>(cursor_.take(n, 3 * float_size, "normals"), is_double);
    } else if (chunk.entity == Entity::vertex && chunk.kind == Kind::texcoord) {
      texcoords_ = to_vectors<2>(cursor_.take(n, 8, "texture coordinates"), false);
    } else if (chunk.entity == Entity::vertex && chunk.kind == Kind::color) {
      file_.colors = to_colors(cursor_.take(n, 3, "colours"));
    } else if (chunk.entity == Entity::vertex && chunk.kind == Kind::topology) {
      cursor_.take(n, std::size_t{1} << chunk.bits, "half-edges of vertices");
    } else if (chunk.entity == Entity::face && chunk.kind == Kind::normal) {
      cursor_.take(n, 3 * float_size, "normals of faces");
    } else if (chunk.entity == Entity::face && chunk.kind == Kind::color) {
      face_colors_ = to_colors(cursor_.take(n, 3, "colours of faces"));
    } else if (chunk.entity == Entity::face && chunk.kind == Kind::topology) {
      scan_faces(chunk.bits);
    } else if (chunk.entity == Entity::halfedge && version_ < version_2_0) {
      cursor_.fail("half-edges in version 2.0 and later alone", "some in one before");
    } else if (chunk.entity == Entity::halfedge && chunk.kind == Kind::texcoord) {
      corner_texcoords_ = to_vectors<2>(cursor_.take(n, 8, "texture coordinates"), false);
    } else if (chunk.entity == Entity::halfedge && chunk.kind == Kind::topology) {
      scan_halfedges(chunk.bits);
    } else {
      cursor_.fail("a chunk that OpenMesh writes",
                   fmt::format("entity {} with type {}", static_cast<int>(chunk.entity),
                               static_cast<int>(chunk.kind)));
    }
  }

  void take_name() { cursor_.take(cursor_.value<std::uint8_t>("a name's length"), 1, "a name"); }

  void scan_halfedges(int bits) {
    if (!halfedges_.empty()) cursor_.fail("one chunk of half-edges", "a second");
    const std::size_t n = 2 * n_edges_;
    ByteCursor values(path_, cursor_.take(n, std::size_t{3} << bits, "half-edges"));
    halfedges_.reserve(n);
    for (std::size_t h = 0; h < n; ++h) {
      Halfedge e{};
      e.next = values.integer(bits, "half-edges");
      e.to = values.integer(bits, "half-edges");
      e.face = values.integer(bits, "half-edges");
      check(e.next, n, "next half-edge");
      check(e.to, file_.n_vertices, "vertex");
      halfedges_.push_back(e);
    }
  }

  void check(std::int64_t index, std::size_t n, const char* what) const {
    if (index < 0 || index >= static_cast<std::int64_t>(n))
      cursor_.fail(fmt::format("a {} below {} in the chunk that ends here", what, n), fmt::to_string(index));
  }

  void scan_faces(int bits) {
    if (has_faces_) cursor_.fail("one chunk of faces", "a second");
    has_faces_ = true;
    const std::size_t n = file_.n_faces;
    if (version_ >= version_2_0) {
      ByteCursor values(path_, cursor_.take(n, std::size_t{1} << bits, "half-edges of faces"));
      for (std::size_t f = 0; f < n; ++f) {
        first_halfedges_.push_back(values.integer(bits, "half-edges of faces"));
        check(first_halfedges_.back(), 2 * n_edges_, "half-edge");
      }
      return;
    }
    for (std::size_t f = 0; f < n; ++f) {
      const std::size_t n_corners = mesh_ == 'T'   ? 3
                                    : mesh_ == 'Q' ? 4
                                                   : cursor_.count(1, "a count of corners");
      face_ends_.push_back(corners_.size() + n_corners);
      for (std::size_t c = 0; c < n_corners; ++c) {
        const std::uint64_t v = cursor_.count(bits, "the corners of a face");
        if (v >= file_.n_vertices)
          cursor_.fail(fmt::format("a vertex below {}", file_.n_vertices), fmt::to_string(v));
        corners_.push_back(static_cast<std::uint32_t>(v));
      }
    }
  }

  /// Walks around each face; every half-edge belongs to one face, so no walk is longer than there are.
  void collect_faces() {
    if (halfedges_.empty()) throw IoError(path_, "expected half-edges before the sentinel, found none");
    std::vector<bool> is_taken(halfedges_.size(), false);
    for (std::size_t f = 0; f < first_halfedges_.size(); ++f) {
      auto h = static_cast<std::size_t>(first_halfedges_[f]);
      do {
        if (is_taken[h])
          throw IoError(path_,
                        fmt::format("face {}: expected a loop of half-edges of its own, found half-edge "
                                    "{} a second time",
                                    f, h));
        is_taken[h] = true;
        corners_.push_back(static_cast<std::uint32_t>(halfedges_[h].to));
        corner_halfedges_.push_back(static_cast<std::uint32_t>(h));
        h = static_cast<std::size_t>(halfedges_[h].next);
      } while (h != static_cast<std::size_t>(first_halfedges_[f]));
      face_ends_.push_back(corners_.size());
    }
  }

  void finish() {
    if (positions_.size() != file_.n_vertices || positions_.empty())
      throw IoError(path_, "expected positions before the end, found none");
    if (!has_faces_) throw IoError(path_, "expected faces before the end, found none");
    if (version_ >= version_2_0) collect_faces();
    // Colours of the vertices are finer than those of the faces: where a file has both, they win.
    const bool has_face_colors = !face_colors_.empty() && file_.colors.empty();
    const bool has_corner_texcoords = !corner_texcoords_.empty();
    if (has_face_colors) decode_file_colors(face_colors_, file_.findings);
    if (!has_face_colors) tell_unused_face_colors(face_colors_.size(), file_.findings);
    decode_file_colors(file_.colors, file_.findings);
    CornerAttributes attributes(file_, has_corner_texcoords, has_face_colors);
    KeptFaces kept(file_);
    std::string faces;
    std::size_t begin = 0;
    for (std::size_t f = 0; f < face_ends_.size(); begin = face_ends_[f++]) {
      const std::size_t n_corners = face_ends_[f] - begin;
      if (!kept.keep(n_corners)) continue;
      if (n_corners > std::numeric_limits<std::uint16_t>::max())
        throw IoError(path_, fmt::format("face {}: expected at most 65535 corners, found {}", f, n_corners));
      append(faces, static_cast<std::uint16_t>(n_corners));
      for (std::size_t c = begin; c < face_ends_[f]; ++c)
        append(faces,
               attributes.vertex_for(
                   corners_[c], has_corner_texcoords ? corner_texcoords_[corner_halfedges_[c]] : glm::vec2(0),
                   has_face_colors ? face_colors_[f] : LinearRgb{}));
    }
    kept.finish(path_);
    attributes.finish();
    add_finding(file_.findings, "custom_properties", n_custom_, "custom propert[y is|ies are] not read");
    write(kept.n_kept(), faces);
  }

  void write(std::size_t n_faces, const std::string& faces) {
    std::string& out = file_.bytes;
    file_.has_normals = !normals_.empty();
    file_.has_texcoords = !texcoords_.empty();
    const std::size_t n = file_.n_vertices + file_.copied_vertices.size();
    out = "OMP";
    append(out, std::uint8_t{1 << 5});
    append(out, static_cast<std::uint32_t>(n));
    append(out, static_cast<std::uint32_t>(n_faces));
    append(out, std::uint32_t{0});
    const auto write_vectors = [&](Kind kind, int dimensions, const auto& vectors) {
      if (vectors.empty()) return;
      append(out, encode_chunk(Entity::vertex, kind, dimensions, true, 0));
      for (const auto& v : vectors) append(out, v);
      for (const std::uint32_t v : file_.copied_vertices) append(out, vectors[v]);
    };
    write_vectors(Kind::position, 3, positions_);
    write_vectors(Kind::normal, 3, normals_);
    write_vectors(Kind::texcoord, 2, texcoords_);
    append(out, encode_chunk(Entity::face, Kind::topology, 1, false, 2));
    out += faces;
    append(out, encode_chunk(Entity::sentinel, Kind::position, 1, false, 0));
  }

  const std::string& path_;
  ByteCursor cursor_;
  CanonicalFile& file_;
  char mesh_ = 'P';
  std::uint8_t version_ = 0;
  std::size_t n_edges_ = 0, n_custom_ = 0;
  bool has_faces_ = false;
  std::vector<glm::vec3> positions_, normals_;
  std::vector<glm::vec2> texcoords_, corner_texcoords_;  // V; 2E.
  std::vector<LinearRgb> face_colors_;
  std::vector<Halfedge> halfedges_;
  std::vector<std::int64_t> first_halfedges_;
  std::vector<std::uint32_t> corners_, corner_halfedges_;
  std::vector<std::size_t> face_ends_;
};

}  // namespace

CanonicalFile scan_om(const std::string& path) {
  const std::string bytes = read_bytes(path);
  CanonicalFile file;
  file.format = "OM";
  file.is_om = true;
  OmScan(path, bytes, file).run();
  return file;
}

}  // namespace lambake
