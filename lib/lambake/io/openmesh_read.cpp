#include "lambake/io/openmesh_read.h"

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OMReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/Mesh/BaseKernel.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <cstring>
#include <exception>
#include <istream>
#include <mutex>
#include <stdexcept>
#include <streambuf>
#include <string_view>

#include "lambake/core/error.h"
#include "lambake/geometry/triangulate.h"

namespace lambake {
namespace {

using namespace OpenMesh;  // NOLINT: every signature below is OpenMesh's.

/// Takes what OpenMesh's readers deliver into plain arrays.
class ArrayImporter : public IO::BaseImporter {
 public:
  ArrayImporter(const CanonicalFile& file, OpenMeshArrays& arrays) : arrays_(arrays) {
    const std::size_t n = file.n_vertices + file.copied_vertices.size();
    arrays_.positions.reserve(n);
    if (file.has_normals) arrays_.normals.resize(n, glm::vec3(0));
    if (file.has_texcoords) arrays_.texcoords.resize(n, glm::vec2(0));
    arrays_.triangles.reserve(file.n_faces);
  }

  VertexHandle add_vertex(const Vec3f& p) override {
    arrays_.positions.emplace_back(p[0], p[1], p[2]);
    return VertexHandle(static_cast<int>(arrays_.positions.size() - 1));
  }
  VertexHandle add_vertex() override { return add_vertex(Vec3f(0, 0, 0)); }
  void set_point(VertexHandle v, const Vec3f& p) override {
    arrays_.positions[index(v)] = glm::vec3(p[0], p[1], p[2]);
  }
  void set_normal(VertexHandle v, const Vec3f& n) override {
    if (index(v) < arrays_.normals.size()) arrays_.normals[index(v)] = glm::vec3(n[0], n[1], n[2]);
  }
  void set_texcoord(VertexHandle v, const Vec2f& t) override {
    if (index(v) < arrays_.texcoords.size()) arrays_.texcoords[index(v)] = glm::vec2(t[0], t[1]);
  }
  FaceHandle add_face(const VHandles& corners) override {
    const auto face = static_cast<std::uint32_t>(arrays_.n_faces++);
    for (const VertexHandle v : corners)
      if (v.idx() < 0 || index(v) >= arrays_.positions.size())
        throw std::out_of_range("OpenMesh delivered a face before its vertices");
    if (corners.size() == 3) {
      arrays_.triangles.emplace_back(index(corners[0]), index(corners[1]), index(corners[2]));
    } else {
      if (arrays_.faces.empty())
        for (std::uint32_t f = 0; f < face; ++f) arrays_.faces.push_back(f);
      polygon_.clear();
      for (const VertexHandle v : corners) polygon_.push_back(static_cast<std::uint32_t>(v.idx()));
      has_polygons_ = true;
      count_repeated_corners();
      arrays_.n_odd_polygons += !triangulate_polygon(arrays_.positions, polygon_, arrays_.triangles);
    }
    if (has_polygons_) arrays_.faces.resize(arrays_.triangles.size(), face);
    return FaceHandle(static_cast<int>(face));
  }
  /// The OM reader wants a kernel for custom properties, of which the canonical files have none.
  BaseKernel* kernel() override { return &kernel_; }
  std::size_t n_vertices() const override { return arrays_.positions.size(); }
  std::size_t n_faces() const override { return arrays_.n_faces; }
  std::size_t n_edges() const override { return 0; }

  // What the canonical files do not hold, or what only a half-edge mesh needs.
  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_normal(VertexHandle, const Vec3d&) override {}
  void set_color(VertexHandle, const Vec3uc&) override {}
  void set_color(VertexHandle, const Vec4uc&) override {}
  void set_color(VertexHandle, const Vec3f&) override {}
  void set_color(VertexHandle, const Vec4f&) override {}
  void set_status(VertexHandle, const Attributes::StatusInfo&) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
  void set_texcoord(VertexHandle, const Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
  void set_status(HalfedgeHandle, const Attributes::StatusInfo&) override {}
  void set_color(EdgeHandle, const Vec3uc&) override {}
  void set_color(EdgeHandle, const Vec4uc&) override {}
  void set_color(EdgeHandle, const Vec3f&) override {}
  void set_color(EdgeHandle, const Vec4f&) override {}
  void set_status(EdgeHandle, const Attributes::StatusInfo&) override {}
  void set_normal(FaceHandle, const Vec3f&) override {}
  void set_normal(FaceHandle, const Vec3d&) override {}
  void set_color(FaceHandle, const Vec3uc&) override {}
  void set_color(FaceHandle, const Vec4uc&) override {}
  void set_color(FaceHandle, const Vec3f&) override {}
  void set_color(FaceHandle, const Vec4f&) override {}
  void set_status(FaceHandle, const Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}

 private:
  void count_repeated_corners() {
    std::size_t n = 0;
    for (std::size_t i = 0; i < polygon_.size(); ++i) n += polygon_[i] == polygon_[(i + 1) % polygon_.size()];
    if (polygon_.size() - n >= 3) arrays_.n_repeated_corners += n;
  }
  static std::size_t index(VertexHandle v) { return static_cast<std::size_t>(v.idx()); }

  OpenMeshArrays& arrays_;
  BaseKernel kernel_;
  std::vector<std::uint32_t> polygon_;
  bool has_polygons_ = false;
};

/// A stream over bytes in memory.
class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(std::string_view bytes) {
    char* const begin =
        const_cast<char*>(bytes.data());  // NOLINT: streambuf has no const form; never written
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  /// The readers ask for a few bytes at a time, four most often.
  std::streamsize xsgetn(char* to, std::streamsize n) override {
    n = std::min<std::streamsize>(n, egptr() - gptr());
    if (n == 4)
      std::memcpy(to, gptr(), 4);
    else
      std::memcpy(to, gptr(), static_cast<std::size_t>(n));
    setg(eback(), gptr() + n, egptr());
    return n;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::cur ? gptr() - eback()
                                                       : egptr() - eback();
    if (base + offset < 0 || base + offset > egptr() - eback()) return pos_type(off_type(-1));
    setg(eback(), eback() + base + offset, egptr());
    return pos_type(base + offset);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override {
    return seekoff(off_type(position), std::ios_base::beg, which);
  }
};

/// OpenMesh's readers print; the library does not.
class Silence {
 public:
  Silence() {
    for (mostream* stream : {&omerr(), &omlog(), &omout()})
      if (stream->is_enabled()) stream->disable(), silenced_.push_back(stream);
  }
  ~Silence() {
    for (mostream* stream : silenced_) stream->enable();
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  std::vector<mostream*> silenced_;
};

}  // namespace

OpenMeshArrays read_with_openmesh(const std::string& path, const CanonicalFile& file) {
  static std::mutex mutex;  // The readers are singletons that keep state.
  const std::lock_guard lock(mutex);
  const Silence silence;
  OpenMeshArrays arrays;
  ArrayImporter importer(file, arrays);
  MemoryBuffer buffer(std::string_view(file.bytes).substr(file.begin));
  std::istream stream(&buffer);
  IO::Options options(IO::Options::Binary);
  if (file.has_normals) options += IO::Options::VertexNormal;
  if (file.has_texcoords) options += IO::Options::VertexTexCoord;
  IO::BaseReader& reader = file.is_om ? static_cast<IO::BaseReader&>(IO::OMReader()) : IO::PLYReader();
  bool is_read = false;
  try {
    is_read = reader.read(stream, importer, options);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw IoError(path, std::string("OpenMesh's reader failed: ") + error.what());
  }
  if (!is_read) throw IoError(path, "OpenMesh's reader failed");
  return arrays;
}

}  // namespace lambake
