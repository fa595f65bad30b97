// A whole `lambake bake` of 1 M vertices and 2 M triangles to GLB, against OpenMesh's reader filling plain
// arrays: from a binary PLY with a write of as many bytes as the GLB has, from text alone. `tool/bench` runs
// it and prints the ratios.
#include <benchmark/benchmark.h>

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "lambake/bake/bake.h"
#include "lambake/geometry/normals.h"
#include "lambake/io/gltf.h"
#include "lambake/io/scene_file.h"
#include "wavy_floor.h"

namespace lambake {
namespace {

using namespace OpenMesh;

/// Fills plain arrays and checks nothing: the least that reading can do.
class BareImporter : public IO::BaseImporter {
 public:
  VertexHandle add_vertex(const Vec3f& p) override {
    positions.emplace_back(p[0], p[1], p[2]);
    return VertexHandle(static_cast<int>(positions.size()) - 1);
  }
  VertexHandle add_vertex() override { return add_vertex(Vec3f(0, 0, 0)); }
  FaceHandle add_face(const VHandles& v) override {
    triangles.emplace_back(v[0].idx(), v[1].idx(), v[2].idx());
    return FaceHandle(static_cast<int>(triangles.size()) - 1);
  }
  void set_point(VertexHandle v, const Vec3f& p) override {
    positions[static_cast<std::size_t>(v.idx())] = {p[0], p[1], p[2]};
  }
  std::size_t n_vertices() const override { return positions.size(); }
  std::size_t n_faces() const override { return triangles.size(); }
  BaseKernel* kernel() override { return nullptr; }
  std::size_t n_edges() const override { return 0; }
  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_normal(VertexHandle, const Vec3f&) override {}
  void set_normal(VertexHandle, const Vec3d&) override {}
  void set_color(VertexHandle, const Vec3uc&) override {}
  void set_color(VertexHandle, const Vec4uc&) override {}
  void set_color(VertexHandle, const Vec3f&) override {}
  void set_color(VertexHandle, const Vec4f&) override {}
  void set_status(VertexHandle, const Attributes::StatusInfo&) override {}
  void set_texcoord(VertexHandle, const Vec2f&) override {}
  void set_texcoord(VertexHandle, const Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
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
  void request_face_texcoords2D() override {}

  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
};

const std::filesystem::path folder = std::filesystem::temp_directory_path() / "lambake_bench";

enum class Format { binary_ply, ascii_ply, obj };

/// The floor of 1 M vertices and 2 M triangles as a file; made once.
std::string floor_file(Format format) {
  static std::map<Format, std::string> made;
  std::string& path = made[format];
  if (!path.empty()) return path;
  std::filesystem::create_directories(folder);
  const Mesh mesh = wavy_floor(1000);
  path = (folder / (format == Format::obj         ? "floor.obj"
                    : format == Format::ascii_ply ? "ascii.ply"
                                                  : "floor.ply"))
             .string();
  std::ofstream file(path, std::ios::binary);
  if (format != Format::obj)
    file << "ply\nformat " << (format == Format::ascii_ply ? "ascii" : "binary_little_endian")
         << " 1.0\nelement vertex " << mesh.n_vertices()
         << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.n_triangles()
         << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const glm::vec3& p : mesh.positions) {
    if (format == Format::binary_ply)
      file.write(reinterpret_cast<const char*>(&p), sizeof p);
    else
      file << (format == Format::obj ? "v " : "") << p.x << ' ' << p.y << ' ' << p.z << '\n';
  }
  for (const glm::uvec3& t : mesh.triangles) {
    if (format == Format::binary_ply)
      file.put(3).write(reinterpret_cast<const char*>(&t), sizeof t);
    else if (format == Format::ascii_ply)
      file << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
    else
      file << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
  }
  return path;
}

void openmesh_reads(const std::string& path, BareImporter& importer, benchmark::State& state) {
  IO::Options options;
  IO::BaseReader& reader =
      path.ends_with(".obj") ? static_cast<IO::BaseReader&>(IO::OBJReader()) : IO::PLYReader();
  if (!reader.read(path, importer, options) || importer.n_vertices() != 1000000)
    state.SkipWithError("OpenMesh could not read");
}

void openmesh_reads_and_bytes_are_written(benchmark::State& state) {
  const std::string path = floor_file(Format::binary_ply);
  for (auto _ : state) {
    BareImporter importer;
    openmesh_reads(path, importer, state);
    // As many bytes as the GLB below: position, normal, colour of 16 bit, indices.
    const std::vector<char> bytes(importer.n_vertices() * 32 + importer.n_faces() * 12, 1);
    std::ofstream(folder / "bytes", std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
}
BENCHMARK(openmesh_reads_and_bytes_are_written)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void openmesh_reads(benchmark::State& state, Format format) {
  const std::string path = floor_file(format);
  for (auto _ : state) {
    BareImporter importer;
    openmesh_reads(path, importer, state);
  }
}
BENCHMARK_CAPTURE(openmesh_reads, ascii_ply, Format::ascii_ply)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(openmesh_reads, obj, Format::obj)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void bake_to_glb(benchmark::State& state, Format format) {
  const std::string path = floor_file(format);
  for (auto _ : state) {
    SceneFile file = read_scene_file(path);
    file.scene.mesh.normals = vertex_normals(file.scene.mesh, NormalWeight::angle).normals;
    file.scene.lights.resize(1);
    write_gltf_file((folder / "floor.glb").string(), file, bake(file.scene, {}), {});
  }
}
BENCHMARK_CAPTURE(bake_to_glb, binary_ply, Format::binary_ply)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bake_to_glb, ascii_ply, Format::ascii_ply)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bake_to_glb, obj, Format::obj)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lambake

BENCHMARK_MAIN();
