#include "model_files.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <iterator>

#include "lambake/geometry/normals.h"

namespace lambake {
namespace {

static_assert(std::endian::native == std::endian::little);

/// Appends the bytes of `value`, most significant first if `is_big`.
template <typename T>
void append(std::string& bytes, T value, bool is_big = false) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  if (is_big)
    bytes.append(raw.rbegin(), raw.rend());
  else
    bytes.append(raw.begin(), raw.end());
}

}  // namespace

std::string ply_bytes(const Mesh& mesh, PlyFormat format) {
  constexpr const char* names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::string out = fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", names[static_cast<int>(format)],
                                mesh.n_vertices());
  out += "property float x\nproperty float y\nproperty float z\n";
  if (!mesh.normals.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.colors.empty()) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  out += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                     mesh.n_triangles());

  const bool is_ascii = format == PlyFormat::ascii, is_big = format == PlyFormat::big_endian;
  const auto vector = [&](const glm::vec3& v) {
    if (is_ascii) fmt::format_to(std::back_inserter(out), "{} {} {} ", v.x, v.y, v.z);
    if (!is_ascii)
      for (int c = 0; c < 3; ++c) append(out, v[c], is_big);
  };
  const auto end_line = [&] {
    if (is_ascii) out.back() = '\n';
  };
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
    vector(mesh.positions[v]);
    if (!mesh.normals.empty()) vector(mesh.normals[v]);
    if (!mesh.colors.empty()) {
      const Srgb8 c = to_srgb8(mesh.colors[v]);
      if (is_ascii) fmt::format_to(std::back_inserter(out), "{} {} {} ", c.r, c.g, c.b);
      if (!is_ascii)
        for (const std::uint8_t channel : {c.r, c.g, c.b}) append(out, channel);
    }
    end_line();
  }
  for (const glm::uvec3& t : mesh.triangles) {
    if (is_ascii) {
      fmt::format_to(std::back_inserter(out), "3 {} {} {}\n", t.x, t.y, t.z);
      continue;
    }
    append(out, std::uint8_t{3});
    for (int c = 0; c < 3; ++c) append(out, t[c], is_big);
  }
  return out;
}

std::string obj_bytes(const Mesh& mesh) {
  std::string out;
  for (const glm::vec3& p : mesh.positions)
    fmt::format_to(std::back_inserter(out), "v {} {} {}\n", p.x, p.y, p.z);
  for (const glm::vec3& n : mesh.normals)
    fmt::format_to(std::back_inserter(out), "vn {} {} {}\n", n.x, n.y, n.z);
  for (const glm::uvec3& t : mesh.triangles) {
    out += 'f';
    for (int c = 0; c < 3; ++c)
      out += mesh.normals.empty() ? fmt::format(" {}", t[c] + 1) : fmt::format(" {0}//{0}", t[c] + 1);
    out += '\n';
  }
  return out;
}

std::string off_bytes(const Mesh& mesh) {
  std::string out = fmt::format("OFF\n{} {} 0\n", mesh.n_vertices(), mesh.n_triangles());
  for (const glm::vec3& p : mesh.positions)
    fmt::format_to(std::back_inserter(out), "{} {} {}\n", p.x, p.y, p.z);
  for (const glm::uvec3& t : mesh.triangles)
    fmt::format_to(std::back_inserter(out), "3 {} {} {}\n", t.x, t.y, t.z);
  return out;
}

std::string stl_ascii_bytes(const Mesh& mesh, const std::string& name) {
  const std::vector<glm::vec3> normals = face_normals(mesh);
  std::string out = "solid " + name + "\n";
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::vec3& n = normals[f];
    fmt::format_to(std::back_inserter(out), "facet normal {} {} {}\nouter loop\n", n.x, n.y, n.z);
    for (int c = 0; c < 3; ++c) {
      const glm::vec3& p = mesh.positions[mesh.triangles[f][c]];
      fmt::format_to(std::back_inserter(out), "vertex {} {} {}\n", p.x, p.y, p.z);
    }
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid " + name + "\n";
}

std::string stl_binary_bytes(const Mesh& mesh, const std::string& header) {
  const std::vector<glm::vec3> normals = face_normals(mesh);
  std::string out = header;
  out.resize(80, ' ');
  append(out, static_cast<std::uint32_t>(mesh.n_triangles()));
  const auto vector = [&](const glm::vec3& v) {
    for (int c = 0; c < 3; ++c) append(out, v[c]);
  };
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    vector(normals[f]);
    for (int c = 0; c < 3; ++c) vector(mesh.positions[mesh.triangles[f][c]]);
    append(out, std::uint16_t{0});
  }
  return out;
}

}  // namespace lambake
