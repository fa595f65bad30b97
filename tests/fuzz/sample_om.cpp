#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <sstream>

#include "fuzz/sample_mesh_files.h"

namespace lambake {

std::string sample_om() {
  using Mesh = OpenMesh::PolyMesh_ArrayKernelT<>;
  Mesh mesh;
  mesh.request_vertex_normals();
  mesh.request_face_colors();
  mesh.request_halfedge_texcoords2D();
  const Mesh::VertexHandle v[5] = {mesh.add_vertex({0, 0, 0}), mesh.add_vertex({1, 0, 0}),
                                   mesh.add_vertex({1, 1, 0.5f}), mesh.add_vertex({0, 1, 0.25f}),
                                   mesh.add_vertex({0.5f, 0.5f, 2})};
  for (const Mesh::VertexHandle vertex : v) mesh.set_normal(vertex, {0, 0, 1});
  mesh.set_color(mesh.add_face(v[0], v[1], v[4]), {255, 0, 0});
  mesh.set_color(mesh.add_face(v[1], v[2], v[4]), {0, 255, 0});
  mesh.set_color(mesh.add_face({v[0], v[3], v[2], v[1]}), {0, 0, 255});
  float u = 0;
  for (const Mesh::HalfedgeHandle h : mesh.halfedges()) mesh.set_texcoord2D(h, {u += 0.0625f, 0.5f});
  omlog().disable();  // The writer tells the number of bytes.
  std::ostringstream stream(std::ios::binary);
  OpenMesh::IO::write_mesh(mesh, stream, ".om",
                           OpenMesh::IO::Options::VertexNormal | OpenMesh::IO::Options::FaceColor |
                               OpenMesh::IO::Options::FaceTexCoord);
  return stream.str();
}

}  // namespace lambake
