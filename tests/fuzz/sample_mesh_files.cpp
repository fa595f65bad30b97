#include "fuzz/sample_mesh_files.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace lambake {
namespace {

template <typename T>
void append(std::string& bytes, T value, bool is_big_endian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (is_big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

constexpr float corners[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0.25f}, {0.5f, 0.5f, 2}};

std::string ply_binary(bool is_big_endian) {
  std::string bytes = std::string("ply\nformat binary_") + (is_big_endian ? "big" : "little") +
                      "_endian 1.0\ncomment TextureFile none.png\nelement vertex 5\nproperty float x\n"
                      "property double y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
                      "property uchar blue\nelement junk 2\nproperty list ushort short values\n"
                      "element face 3\nproperty list uchar int vertex_indices\n"
                      "property list uchar float texcoord\nend_header\n";
  for (const auto& p : corners) {
    append(bytes, p[0], is_big_endian);
    append(bytes, static_cast<double>(p[1]), is_big_endian);
    append(bytes, p[2], is_big_endian);
    for (int c = 0; c < 3; ++c) append(bytes, static_cast<std::uint8_t>(40 * c + 7));
  }
  append(bytes, std::uint16_t{0}, is_big_endian);
  append(bytes, std::uint16_t{2}, is_big_endian);
  append(bytes, std::int16_t{-5}, is_big_endian);
  append(bytes, std::int16_t{700}, is_big_endian);
  const std::vector<std::vector<std::int32_t>> faces{{0, 1, 4}, {1, 2, 4}, {0, 3, 2, 1}};
  for (const auto& face : faces) {
    append(bytes, static_cast<std::uint8_t>(face.size()));
    for (const std::int32_t v : face) append(bytes, v, is_big_endian);
    append(bytes, static_cast<std::uint8_t>(2 * face.size()));
    for (std::size_t i = 0; i < 2 * face.size(); ++i)
      append(bytes, 0.125f * static_cast<float>(i), is_big_endian);
  }
  return bytes;
}

/// What take_plain_ply() takes.
std::string ply_plain() {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment with one\nelement vertex 5\nproperty float x\n"
      "property float y\nproperty float z\nelement face 3\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  for (const auto& p : corners)
    for (const float coordinate : p) append(bytes, coordinate);
  const std::vector<std::vector<std::int32_t>> faces{{0, 1, 4}, {1, 2, 4}, {0, 3, 2, 1}};
  for (const auto& face : faces) {
    append(bytes, static_cast<std::uint8_t>(face.size()));
    for (const std::int32_t v : face) append(bytes, v);
  }
  return bytes;
}

std::string stl_binary() {
  std::string bytes = "solid, though binary";
  bytes.resize(80, ' ');
  append(bytes, std::uint32_t{3});
  constexpr int faces[3][3] = {{0, 1, 4}, {1, 2, 4}, {2, 2, 3}};
  for (const auto& face : faces) {
    for (int c = 0; c < 3; ++c) append(bytes, 0.0f);
    for (const int v : face)
      for (const float coordinate : corners[v]) append(bytes, coordinate);
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

/// Version 1.2, whose faces are lists of vertices.
std::string om_version_1() {
  std::string bytes = "OMT\x22";
  for (const std::uint32_t n : {5U, 2U, 0U}) append(bytes, n);
  append(bytes, std::uint16_t{0x1600});  // Positions of vertices: three floats.
  for (const auto& p : corners)
    for (const float coordinate : p) append(bytes, coordinate);
  append(bytes, std::uint16_t{0x1288});  // Colours of faces.
  for (const std::uint8_t c : {255, 0, 0, 0, 255, 0}) append(bytes, c);
  append(bytes, std::uint16_t{0x00e8});  // Topology of faces: whole numbers of one byte.
  for (const std::uint8_t v : {0, 1, 4, 1, 2, 4}) append(bytes, v);
  return bytes;
}

constexpr const char* ply_ascii =
    "ply\nformat ascii 1.0\nobj_info made by hand\nelement vertex 5\nproperty float x\nproperty float y\n"
    "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 3\n"
    "property list uchar int vertex_indices\nproperty float red\nproperty float green\nproperty float blue\n"
    "end_header\n"
    "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 nan 0 1 0\n0 1 0.25 0 0 1\n.5 5e-1 2 0 0 1\n"
    "3 0 1 4 1 0 0\n3 1 2 4 0 0.5 0\n4 0 3 2 1 0 0 1.0\n";
constexpr const char* ply_strips =
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0.25\n.5 5e-1 2\n8 0 1 2 3 -1 1 2 4\n";
constexpr const char* obj =
    "# a comment\nmtllib missing.mtl\no thing\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 inf 0 0 1\nv 0 1 .25 1 1 "
    "1\n"
    "v .5 .5 2 0 0 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\nusemtl red\ng part\ns 1\n"
    "f 1/1/1 2/2/1 5/3/1\nf 2/1/2 3/2/1 \\\n5/3/2\nf -5/1/1 -2/1/1 -3/3/2 -4/2/2\nf 1/1/1 1/1/1 2/2/2\n";
constexpr const char* off =
    "OFF\n# a comment\n5 3 0\n0 0 0\n1 0 0\n1 1 nan\n0 1 .25\n.5 .5 2\n3 0 1 4 255 0 0\n3 1 2 4 0 128 0\n"
    "4 0 3 2 1 0 0 255\n";
constexpr const char* coff =
    "STCNOFF\n5 2 0\n0 0 0 0 0 1 1 0\n1 0 0 0 0 1 1 0\n1 1 0 0 0 1 1 0\n0 1 .25 0 0 1 1 0\n.5 .5 2 0 1 0 0 "
    "1\n"
    "3 0 1 4\n4 0 3 2 1\n";
constexpr const char* stl_ascii =
    "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex .5 .5 "
    "2\nendloop\nendfacet\n"
    "facet normal nan 0 1\n outer loop\n  vertex 0 0 0\n  vertex 0 0 0\n  vertex 1 inf 0\n "
    "endloop\nendfacet\n"
    "endsolid one\n";

}  // namespace

std::vector<SampleFile> sample_mesh_files() {
  const auto text = [](const char* name, const std::string& bytes, const char* last_needed, std::size_t n) {
    return SampleFile{name, bytes, bytes.rfind(last_needed) + n};
  };
  const auto binary = [](const char* name, const std::string& bytes) {
    return SampleFile{name, bytes, bytes.size()};
  };
  // A shortened number is still a number; the colour of a face is optional.
  return {text("ascii.ply", ply_ascii, "1.0", 1),
          text("strips.ply", ply_strips, "4", 1),
          binary("little.ply", ply_binary(false)),
          binary("big.ply", ply_binary(true)),
          binary("plain.ply", ply_plain()),
          {"mesh.obj", obj},
          text("plain.off", off, "1 0 0 255", 1),
          text("attributes.off", coff, "1", 1),
          text("ascii.stl", stl_ascii, "endsolid", 8),
          binary("binary.stl", stl_binary()),
          binary("halfedges.om", sample_om()),
          binary("lists.om", om_version_1())};
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::filesystem::remove(path);  // Some file systems flush a file that is truncated and written again.
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace lambake
